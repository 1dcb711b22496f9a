// The container of glTF 2.0: one JSON chunk, one binary chunk, and parts of the latter exchanged for others.

const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;

/** {gltf, binary} of a whole GLB. */
export function readGlb(bytes) {
  if (bytes.length < 20 || bytes.toString("latin1", 0, 4) !== "glTF" || bytes.readUInt32LE(4) !== 2) throw new Error("not a GLB of version 2");
  let gltf, binary = Buffer.alloc(0);
  for (let at = 12; at + 8 <= bytes.length; at += 8 + bytes.readUInt32LE(at)) {
    const content = bytes.subarray(at + 8, at + 8 + bytes.readUInt32LE(at));
    if (bytes.readUInt32LE(at + 4) === JSON_CHUNK) gltf = JSON.parse(content);
    if (bytes.readUInt32LE(at + 4) === BINARY_CHUNK) binary = content;
  }
  if (!gltf) throw new Error("a GLB without a JSON chunk");
  return { gltf, binary };
}

export function viewBytes({ gltf, binary }, index) {
  const { byteOffset = 0, byteLength } = gltf.bufferViews[index];
  return Buffer.from(binary.subarray(byteOffset, byteOffset + byteLength));
}

const padded = (bytes, fill) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4, fill)]);

function chunk(type, bytes) {
  const head = Buffer.alloc(8);
  head.writeUInt32LE(bytes.length, 0);
  head.writeUInt32LE(type, 4);
  return Buffer.concat([head, bytes]);
}

/** The GLB with the buffer views in `exchanged` (index -> bytes) in place of its own; offsets and lengths in `gltf` are set anew. */
export function writeGlb(glb, exchanged) {
  const parts = glb.gltf.bufferViews.map((view, index) => exchanged.get(index) ?? viewBytes(glb, index));
  let offset = 0;
  glb.gltf.bufferViews.forEach((view, index) => {
    view.byteOffset = offset;
    view.byteLength = parts[index].length;
    offset += parts[index].length + ((4 - (parts[index].length % 4)) % 4);
  });
  glb.gltf.buffers[0].byteLength = offset;
  const chunks = [chunk(JSON_CHUNK, padded(Buffer.from(JSON.stringify(glb.gltf)), " ")), chunk(BINARY_CHUNK, Buffer.concat(parts.map((part) => padded(part, 0))))];
  const body = Buffer.concat(chunks);
  const head = Buffer.alloc(12);
  head.write("glTF", 0, "latin1");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}
