// Tiny scenes as GLB files, whole or broken in one way, and edits of others.
import { readFileSync, writeFileSync } from "node:fs";

const pad = (bytes, fill) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, fill)]);

function chunk(type, bytes) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.write(type, 4, "latin1");
  return Buffer.concat([head, bytes]);
}

export function encodeGlb(json, binary = Buffer.alloc(0)) {
  const chunks = [chunk("JSON", pad(Buffer.from(JSON.stringify(json)), " "))];
  if (binary.length > 0) chunks.push(chunk("BIN\0", pad(binary, 0)));
  const body = Buffer.concat(chunks);
  const head = Buffer.alloc(12);
  head.write("glTF", 0, "latin1");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}

/** {json, binary} of a file, for writeGlb. */
export function readGlb(file) {
  const bytes = readFileSync(file);
  const jsonLength = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + jsonLength).toString("utf8"));
  return { json, binary: bytes.subarray(28 + jsonLength, 28 + jsonLength + bytes.readUInt32LE(20 + jsonLength)) };
}

/** One node with one mesh of unindexed triangles; `positions` is a flat list of numbers. */
export function triangles(positions) {
  const binary = Buffer.from(new Float32Array(positions).buffer);
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: "only" }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min: [-9, -9, -9], max: [9, 9, 9] }],
    bufferViews: [{ buffer: 0, byteLength: binary.length }],
    buffers: [{ byteLength: binary.length }],
  };
  return { json, binary };
}

/** Writes it after `change(json)`. */
export function writeGlb(file, { json, binary }, change = () => {}) {
  const changed = structuredClone(json);
  change(changed);
  writeFileSync(file, encodeGlb(changed, binary));
  return file;
}
