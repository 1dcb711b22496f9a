// placement.json as a renderer reads it (configs/placement.schema.json): what to draw for any view. Depends on nothing.

export type Vector = readonly [number, number, number];
export interface Box {
  readonly min: Vector;
  readonly max: Vector;
}
export type FaceName = "+x" | "-x" | "+y" | "-y" | "+z" | "-z";

export interface Cell extends Box {
  readonly level: number;
  readonly index: Vector;
  readonly visible_objects: readonly number[] | null; // null: all
}
export interface Interval {
  readonly face: FaceName;
  readonly level: number;
  readonly index: readonly [number, number];
}
export interface Cpv {
  readonly cell: number;
  readonly interval: number;
  readonly bound_before_ms: number;
  readonly bound_after_ms: number;
  readonly solved: boolean;
  readonly impostors: readonly number[];
}
export interface Impostor {
  readonly id: number;
  readonly technique: string;
  readonly guarantee: string;
  readonly objects: readonly number[];
  readonly texture_bytes: number;
  readonly time_bound_ms: number;
  readonly gltf_node: string;
}
export interface SceneObject {
  readonly id: number;
  readonly name: string;
  readonly gltf_node: string;
  readonly bounds: Box;
}
export interface Level {
  readonly least_distance: number;
  readonly triangles: number;
  readonly gltf_node: string;
}
export interface Lods {
  readonly objects: readonly { readonly object: number; readonly levels: readonly Level[] }[];
}

export interface Placement {
  readonly format: "standin.placement";
  readonly version: 1;
  readonly budget_ms: number;
  readonly camera: { readonly fov_y_deg: number; readonly width: number; readonly height: number };
  readonly scene: { readonly name: string; readonly sha256: string; readonly objects: readonly SceneObject[] };
  readonly view_space: {
    readonly kind: string;
    readonly root: { readonly min: Vector; readonly side: number };
    readonly boxes: readonly Box[];
  };
  readonly cells: readonly Cell[]; // ascending by (level, index)
  readonly intervals: readonly Interval[]; // ascending by (face, level, index)
  readonly cpvs: readonly Cpv[]; // ascending by (cell, interval)
  readonly impostors: readonly Impostor[];
  readonly lods: Lods | null;
}

/// Throws an Error that says what is wrong with a file of another kind or version, or whose entries refer to nothing.
export function parsePlacement(text: string): Placement {
  const placement = JSON.parse(text) as Placement;
  if (placement.format !== "standin.placement" || placement.version !== 1)
    throw new Error(
      `format ${JSON.stringify(placement.format)} version ${JSON.stringify(placement.version)} is not standin.placement version 1`,
    );
  const require = (holds: boolean, what: string) => {
    if (!holds) throw new Error(`placement: ${what} is out of range`);
  };
  placement.cpvs.forEach((cpv, id) => {
    require(cpv.cell < placement.cells.length, `cpvs[${id}].cell`);
    require(cpv.interval < placement.intervals.length, `cpvs[${id}].interval`);
    require(cpv.impostors.every((impostor) => impostor < placement.impostors.length), `cpvs[${id}].impostors`);
  });
  placement.impostors.forEach((impostor, id) =>
    require(impostor.objects.every((object) => object < placement.scene.objects.length), `impostors[${id}].objects`),
  );
  return placement;
}
