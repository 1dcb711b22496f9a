// A GLB file's two chunks, for what is read without three.js' loader: lists of corners in lods.glb.

interface Accessor {
  bufferView: number;
  byteOffset?: number;
  componentType: number;
  count: number;
}
interface Primitive {
  indices?: number;
  extras?: { scene_mesh?: number; scene_primitive?: number };
}
export interface GlbJson {
  nodes?: { name?: string; mesh?: number }[];
  meshes?: { primitives: Primitive[] }[];
  accessors?: Accessor[];
  bufferViews?: { byteOffset?: number; byteLength: number }[];
}
export interface Glb {
  readonly json: GlbJson;
  readonly binary: ArrayBuffer;
}

const MAGIC = 0x46546c67;

export const isGlb = (file: ArrayBuffer) => file.byteLength >= 20 && new DataView(file).getUint32(0, true) === MAGIC;

export function readGlb(file: ArrayBuffer): Glb {
  if (!isGlb(file)) throw new Error("not a GLB file");
  const view = new DataView(file);
  const jsonBytes = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(file, 20, jsonBytes))) as GlbJson;
  const binaryAt = 20 + jsonBytes;
  return {
    json,
    binary: binaryAt + 8 <= file.byteLength ? file.slice(binaryAt + 8, binaryAt + 8 + view.getUint32(binaryAt, true)) : new ArrayBuffer(0),
  };
}

/// Indices of an accessor, in its own type.
export function readIndices({ json, binary }: Glb, accessor: number): Uint8Array | Uint16Array | Uint32Array {
  const { bufferView, byteOffset = 0, componentType, count } = json.accessors![accessor]!;
  const at = (json.bufferViews![bufferView]!.byteOffset ?? 0) + byteOffset;
  if (componentType === 5125) return new Uint32Array(binary, at, count);
  if (componentType === 5123) return new Uint16Array(binary, at, count);
  return new Uint8Array(binary, at, count);
}
