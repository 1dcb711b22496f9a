// What is drawn for a view: the impostors of its CPV, and of all other objects that its cell may see the originals, each in the level of
// detail that the cell's distance allows.

import type { Lookup } from "./lookup";
import type { Box, Level, Placement } from "./placement";

export interface ViewContent {
  readonly objects: readonly number[]; // ascending
  readonly levels: readonly number[]; // of each object: 0 its own parts, else entry level - 1 of its levels
  readonly impostors: readonly number[];
}

/// Least distance between points of two boxes; 0 where they touch.
function distance(a: Box, b: Box): number {
  let square = 0;
  for (let axis = 0; axis < 3; ++axis) {
    const gap = Math.max(a.min[axis]! - b.max[axis]!, b.min[axis]! - a.max[axis]!, 0);
    square += gap * gap;
  }
  return Math.sqrt(square);
}

export class PlacementContent {
  private readonly levels = new Map<number, readonly Level[]>();
  private readonly everyObject: readonly number[];

  constructor(private readonly placement: Placement) {
    for (const { object, levels } of placement.lods?.objects ?? []) this.levels.set(object, levels);
    this.everyObject = placement.scene.objects.map((_, id) => id);
  }

  /// `withImpostors` false: what the same view draws without any, to compare.
  of(lookup: Lookup, withImpostors = true): ViewContent {
    const { cells, cpvs, impostors } = this.placement;
    const cell = lookup.cell === null ? null : cells[lookup.cell]!;
    const shown = withImpostors && lookup.cpv !== null ? cpvs[lookup.cpv]!.impostors : [];
    const replaced = new Set(shown.flatMap((id) => impostors[id]!.objects));
    const objects = (cell?.visible_objects ?? this.everyObject).filter((id) => !replaced.has(id));
    return { objects, levels: objects.map((id) => (cell === null ? 0 : this.levelFrom(cell, id))), impostors: shown };
  }

  /// The last level whose least distance the cell's frames keep.
  private levelFrom(cell: Box, object: number): number {
    const levels = this.levels.get(object);
    if (levels === undefined) return 0;
    const from = distance(cell, this.placement.scene.objects[object]!.bounds);
    let level = 0;
    while (level < levels.length && levels[level]!.least_distance <= from) ++level;
    return level;
  }
}
