// The slowest region of each cell of the heat map: where it looks, what may be seen there, and what the placement does about it.

import type { Placement } from "../runtime/placement";
import { count } from "../text";
import type { HeatCell, Triple } from "./metrics";

interface Region {
  readonly direction: Triple;
  readonly text: string;
  readonly y: number;
}

/// Per cell of the heat map: its slowest region's direction, and what it says.
export class Regions {
  private readonly byPlace = new Map<string, Region>();

  constructor(placement: Placement) {
    const slowest = new Map<number, number>();
    placement.cpvs.forEach((cpv, id) => {
      const known = slowest.get(cpv.cell);
      if (known === undefined || placement.cpvs[known]!.bound_before_ms < cpv.bound_before_ms) slowest.set(cpv.cell, id);
    });
    const best = new Map<string, number>();
    placement.cells.forEach((cell, id) => {
      const key = keyOf({ x0: cell.min[0], z0: cell.min[2] });
      const cpv = slowest.get(id),
        time = cpv === undefined ? 0 : placement.cpvs[cpv]!.bound_before_ms;
      if (this.byPlace.has(key) && (best.get(key) ?? 0) >= time) return;
      best.set(key, time);
      this.byPlace.set(key, regionOf(placement, id, cpv));
    });
  }

  at(cell: HeatCell): Region | undefined {
    return this.byPlace.get(keyOf(cell));
  }
}

const keyOf = ({ x0, z0 }: { x0: number; z0: number }) => `${x0.toFixed(3)} ${z0.toFixed(3)}`;

function regionOf(placement: Placement, cellId: number, cpvId: number | undefined): Region {
  const cell = placement.cells[cellId]!;
  const y = (cell.min[1] + cell.max[1]) / 2;
  const seen = cell.visible_objects === null ? "all objects may be seen" : `${count(cell.visible_objects.length)} objects may be seen`;
  if (cpvId === undefined) return { direction: [0, 0, -1], text: `${seen}; no slow direction`, y };
  const cpv = placement.cpvs[cpvId]!;
  const direction = middleOf(placement, cpv.interval);
  const help =
    cpv.impostors.length === 0 ? "no impostor" : `${count(cpv.impostors.length)} ${cpv.impostors.length === 1 ? "impostor" : "impostors"}`;
  return { direction, text: `slowest looking ${compass(direction)}, where ${seen}; ${help}${cpv.solved ? "" : ", not solved"}`, y };
}

/// Middle direction of an interval: d ~ n + tan(a) u + tan(b) v on its face.
function middleOf(placement: Placement, id: number): Triple {
  const { face, level, index } = placement.intervals[id]!;
  const { n, u, v } = (placement as unknown as { faces: Record<string, { n: Triple; u: Triple; v: Triple }> }).faces[face]!;
  const [a, b] = index.map((i) => Math.tan((Math.PI / 4) * ((2 * i + 1) / 2 ** level - 1))) as [number, number];
  const direction = [0, 1, 2].map((axis) => n[axis]! + a * u[axis]! + b * v[axis]!);
  const length = Math.hypot(...direction);
  return direction.map((value) => value / length) as Triple;
}

/// "to +x, 12 degrees up": the plan has x to the right and z downwards.
function compass([x, y, z]: Triple): string {
  const turn = (Math.round(Math.atan2(z, x) / (Math.PI / 4)) + 8) % 8;
  const side = ["right", "down right", "down", "down left", "left", "up left", "up", "up right"][turn]!;
  const pitch = Math.round((Math.asin(y) * 180) / Math.PI);
  return `${side} on the plan${pitch === 0 ? "" : `, ${Math.abs(pitch)}\u00b0 ${pitch > 0 ? "above" : "below"} the horizon`}`;
}
