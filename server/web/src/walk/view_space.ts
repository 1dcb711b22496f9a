// Where a viewer may stand: the view space's boxes, and the nearest place in them.

import type { Box, Placement, Vector } from "../runtime/placement";

const clamped = (point: Vector, { min, max }: Box): [number, number, number] =>
  [0, 1, 2].map((axis) => Math.min(Math.max(point[axis]!, min[axis]!), max[axis]!)) as [number, number, number];
const squareDistance = (a: Vector, b: Vector) => (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2;

export class WalkableSpace {
  constructor(private readonly placement: Placement) {}

  /// The point of the view space nearest to `point`.
  nearest(point: Vector): Vector {
    let best: Vector = point,
      least = Infinity;
    for (const box of this.placement.view_space.boxes) {
      const inside = clamped(point, box);
      const distance = squareDistance(inside, point);
      if (distance < least) [best, least] = [inside, distance];
    }
    return best;
  }

  /// The same place at the eye height that the view space has there; as it is where it has none.
  atEyeHeight(point: Vector): Vector {
    let height: number | null = null;
    for (const { min, max } of this.placement.view_space.boxes) {
      if (point[0] < min[0] || point[0] > max[0] || point[2] < min[2] || point[2] > max[2]) continue;
      const inside = Math.min(Math.max(point[1], min[1]), max[1]);
      if (height === null || Math.abs(inside - point[1]) < Math.abs(height - point[1])) height = inside;
    }
    return height === null ? point : [point[0], height, point[2]];
  }
}
