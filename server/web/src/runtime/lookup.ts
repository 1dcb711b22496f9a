// Which part of a placement a view uses: render/base/placement_lookup.h in TypeScript, step by step the same, held to the same golden queries.
// That header words the rule of borders and ties. find() allocates no more than its answer.

import type { Cell, FaceName, Interval, Placement, Vector } from "./placement";

export interface Lookup {
  readonly cell: number | null; // null: outside the view space, all originals are drawn
  readonly cpv: number | null; // null: no impostors
}

const FACES: readonly FaceName[] = ["+x", "-x", "+y", "-y", "+z", "-z"];
const EIGHTH_TURN = 0.78539816339744830962;

/// First index in [low, high) whose order against the wanted entry is not negative.
function lowerBound(low: number, high: number, order: (index: number) => number): number {
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (order(middle) < 0) low = middle + 1;
    else high = middle;
  }
  return low;
}

/// The half-open slab of `level` that holds `coordinate`; -1 or 2^level beyond the root.
function slabOf(coordinate: number, rootMin: number, rootSide: number, level: number): number {
  const count = 2 ** level;
  const side = rootSide / count;
  const border = (index: number) => rootMin + side * index;
  if (!(coordinate >= rootMin)) return -1;
  if (coordinate >= border(count)) return count;
  let index = Math.min(Math.max(Math.trunc((coordinate - rootMin) / side), 0), count - 1);
  while (coordinate < border(index)) --index;
  while (coordinate >= border(index + 1)) ++index;
  return index;
}

const angleBorder = (index: number, level: number) => EIGHTH_TURN * (index * 2 ** (1 - level) - 1);

/// The half-open angle interval of `level`; the last one is closed.
function angleSlot(angle: number, level: number): number {
  const count = 2 ** level;
  const index = Math.min(Math.max(Math.floor((angle / EIGHTH_TURN + 1) * 0.5 * count), 0), count - 1);
  if (index + 1 < count && angle >= angleBorder(index + 1, level)) return index + 1;
  if (index > 0 && angle < angleBorder(index, level)) return index - 1;
  return index;
}

interface FaceAngles {
  face: number;
  a: number;
  b: number;
}

function faceAngles([dx, dy, dz]: Vector): FaceAngles | null {
  const x = Math.abs(dx),
    y = Math.abs(dy),
    z = Math.abs(dz);
  if (x >= y && x >= z && x > 0)
    return dx > 0 ? { face: 0, a: Math.atan2(-dz, x), b: Math.atan2(dy, x) } : { face: 1, a: Math.atan2(dz, x), b: Math.atan2(dy, x) };
  if (y >= z && y > 0)
    return dy > 0 ? { face: 2, a: Math.atan2(dx, y), b: Math.atan2(-dz, y) } : { face: 3, a: Math.atan2(dx, y), b: Math.atan2(dz, y) };
  if (!(z > 0)) return null;
  return dz > 0 ? { face: 4, a: Math.atan2(dx, z), b: Math.atan2(dy, z) } : { face: 5, a: Math.atan2(-dx, z), b: Math.atan2(dy, z) };
}

const holds = (cell: Cell, position: Vector) =>
  cell.min[0] <= position[0] &&
  position[0] <= cell.max[0] &&
  cell.min[1] <= position[1] &&
  position[1] <= cell.max[1] &&
  cell.min[2] <= position[2] &&
  position[2] <= cell.max[2];

export class PlacementLookup {
  private readonly intervalLevels: readonly number[]; // those in use, finest first

  constructor(private readonly placement: Placement) {
    this.intervalLevels = [...new Set(placement.intervals.map((interval) => interval.level))].sort((a, b) => b - a);
  }

  /// Cell and CPV of a view. The direction's length does not matter.
  find(position: Vector, direction: Vector): Lookup {
    const cell = this.findCell(position);
    return { cell, cpv: cell === null ? null : this.findCpv(cell, direction) };
  }

  findCell(position: Vector): number | null {
    const {
      cells,
      view_space: { root },
    } = this.placement;
    if (cells.length === 0) return null;
    const finest = cells[cells.length - 1]!.level;
    const side = root.side / 2 ** finest;
    const index: [number, number, number] = [0, 0, 0];
    let onBorders = 0; // bit 2, 1, 0 for x, y, z: then the slab below is closed there and may hold the position too
    for (let axis = 0; axis < 3; ++axis) {
      index[axis] = slabOf(position[axis]!, root.min[axis]!, root.side, finest);
      if (index[axis]! < 0) return null;
      if (index[axis]! > 0 && position[axis] === root.min[axis]! + side * index[axis]!) onBorders |= 4 >> axis;
    }
    // Eight ways to step down across borders; those that do not in x come first, of these those that do not in y.
    for (let down = 0; down < 8; ++down) {
      if ((down & onBorders) !== down) continue;
      const found = this.leafAbove(index[0] - (down >> 2), index[1] - ((down >> 1) & 1), index[2] - (down & 1), position);
      if (found !== null) return found;
    }
    return null;
  }

  private leafAbove(x: number, y: number, z: number, position: Vector): number | null {
    const { cells } = this.placement;
    const finest = cells[cells.length - 1]!.level;
    for (let level = finest; level >= cells[0]!.level; --level) {
      const shift = finest - level;
      const id = this.cellAt(level, x >> shift, y >> shift, z >> shift);
      if (id !== null && holds(cells[id]!, position)) return id;
    }
    return null;
  }

  private cellAt(level: number, x: number, y: number, z: number): number | null {
    const { cells } = this.placement;
    const order = (id: number) => {
      const cell = cells[id]!;
      return cell.level - level || cell.index[0] - x || cell.index[1] - y || cell.index[2] - z;
    };
    const id = lowerBound(0, cells.length, order);
    return id < cells.length && order(id) === 0 ? id : null;
  }

  findCpv(cell: number, direction: Vector): number | null {
    const { cpvs } = this.placement;
    const first = lowerBound(0, cpvs.length, (id) => cpvs[id]!.cell - cell);
    const last = lowerBound(first, cpvs.length, (id) => cpvs[id]!.cell - cell - 1);
    const angles = first === last ? null : faceAngles(direction);
    if (angles === null) return null;
    for (const level of this.intervalLevels) {
      const interval = this.intervalAt(angles.face, level, angleSlot(angles.a, level), angleSlot(angles.b, level));
      if (interval === null) continue;
      const id = lowerBound(first, last, (at) => cpvs[at]!.interval - interval);
      if (id < last && cpvs[id]!.interval === interval) return id;
    }
    return null;
  }

  private intervalAt(face: number, level: number, i: number, j: number): number | null {
    const { intervals } = this.placement;
    const order = (id: number) => {
      const interval: Interval = intervals[id]!;
      return FACES.indexOf(interval.face) - face || interval.level - level || interval.index[0] - i || interval.index[1] - j;
    };
    const id = lowerBound(0, intervals.length, order);
    return id < intervals.length && order(id) === 0 ? id : null;
  }
}
