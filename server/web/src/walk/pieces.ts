// Objects that the program split into pieces (render/scene/split.cpp), split again: a placement names pieces as NAME#K and by their bounds,
// and this finds which triangles of the scene file's node each has. Halves at the median centroid along the longest axis until a piece is
// within the limits. Whether the pieces are the program's is judged by their bounds; a scene that it repaired may differ.

import * as THREE from "three";

export interface SplitLimits {
  readonly triangles: number;
  readonly extent: number;
} // 0: any
export interface PiecePart {
  readonly part: number;
  readonly corners: Uint32Array;
}
export type Piece = readonly PiecePart[];

const LIGHTEST = 500;

class Triangles {
  readonly part: Uint32Array;
  readonly corners: Uint32Array;
  readonly centroid: Float32Array;
  readonly count: number;

  constructor(readonly geometries: readonly THREE.BufferGeometry[]) {
    const indices = geometries.map((geometry) => geometry.index!.array);
    this.count = indices.reduce((sum, index) => sum + Math.floor(index.length / 3), 0);
    this.part = new Uint32Array(this.count);
    this.corners = new Uint32Array(3 * this.count);
    this.centroid = new Float32Array(3 * this.count);
    let at = 0;
    indices.forEach((index, part) => {
      const position = geometries[part]!.getAttribute("position");
      for (let t = 0; t < Math.floor(index.length / 3); ++t, ++at) {
        this.part[at] = part;
        for (let c = 0; c < 3; ++c) this.corners[3 * at + c] = index[3 * t + c]!;
        for (let axis = 0; axis < 3; ++axis) {
          const [a, b, c] = [0, 1, 2].map((corner) => position.getComponent(index[3 * t + corner]!, axis)) as [number, number, number];
          this.centroid[3 * at + axis] = Math.fround(Math.fround(Math.fround(a) + Math.fround(b)) + Math.fround(c)) / 3;
        }
      }
    });
  }

  /// Extents of the triangles' corners.
  size(ids: Uint32Array): [number, number, number] {
    const low = [Infinity, Infinity, Infinity],
      high = [-Infinity, -Infinity, -Infinity];
    for (const id of ids) {
      const position = this.geometries[this.part[id]!]!.getAttribute("position");
      for (let corner = 0; corner < 3; ++corner)
        for (let axis = 0; axis < 3; ++axis) {
          const value = position.getComponent(this.corners[3 * id + corner]!, axis);
          low[axis] = Math.min(low[axis]!, value);
          high[axis] = Math.max(high[axis]!, value);
        }
    }
    return [high[0]! - low[0]!, high[1]! - low[1]!, high[2]! - low[2]!];
  }

  centroidSize(ids: Uint32Array): [number, number, number] {
    const low = [Infinity, Infinity, Infinity],
      high = [-Infinity, -Infinity, -Infinity];
    for (const id of ids)
      for (let axis = 0; axis < 3; ++axis) {
        low[axis] = Math.min(low[axis]!, this.centroid[3 * id + axis]!);
        high[axis] = Math.max(high[axis]!, this.centroid[3 * id + axis]!);
      }
    return [high[0]! - low[0]!, high[1]! - low[1]!, high[2]! - low[2]!];
  }
}

function exceeds(limits: SplitLimits, count: number, size: readonly number[]): boolean {
  if (limits.triangles > 0 && count > limits.triangles) return true;
  return limits.extent > 0 && count >= 2 * LIGHTEST && Math.max(...size) > limits.extent;
}

function piece(triangles: Triangles, ids: Uint32Array): Piece {
  const parts: PiecePart[] = [];
  const sorted = ids.sort(); // ids ascend by part, then by triangle
  for (let begin = 0, end = 0; begin < sorted.length; begin = end) {
    const part = triangles.part[sorted[begin]!]!;
    while (end < sorted.length && triangles.part[sorted[end]!] === part) ++end;
    const corners = new Uint32Array(3 * (end - begin));
    for (let i = begin; i < end; ++i) corners.set(triangles.corners.subarray(3 * sorted[i]!, 3 * sorted[i]! + 3), 3 * (i - begin));
    parts.push({ part, corners });
  }
  return parts;
}

/// `scale`: lengths of the object's axes in the world, of the largest instance that is split. Geometries need an index.
export function splitIntoPieces(
  geometries: readonly THREE.BufferGeometry[],
  scale: readonly [number, number, number],
  limits: SplitLimits,
): Piece[] {
  const triangles = new Triangles(geometries);
  const scaled = (size: readonly number[]) => size.map((value, axis) => value * scale[axis]!);
  const pieces: Piece[] = [];
  const stack = [Uint32Array.from({ length: triangles.count }, (_, id) => id)];
  for (let ids = stack.pop(); ids !== undefined; ids = stack.pop()) {
    if (ids.length < 2 || !exceeds(limits, ids.length, scaled(triangles.size(ids)))) {
      pieces.push(piece(triangles, ids));
      continue;
    }
    const [x, y, z] = scaled(triangles.centroidSize(ids)) as [number, number, number];
    const axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const key = triangles.centroid;
    const sorted = ids.sort((a, b) => key[3 * a + axis]! - key[3 * b + axis]! || a - b);
    const half = Math.floor(sorted.length / 2);
    stack.push(sorted.slice(half), sorted.slice(0, half));
  }
  return pieces;
}
