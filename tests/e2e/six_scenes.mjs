// Six scenes that each need something less than others do, as glTF files: what `place` may leave out (left_out.mjs compares, tests/bench
// times). Spheres on a field, houses, pieces far away: small on purpose, `detail` makes them heavier.
import { join } from "node:path";
import { deflateSync } from "node:zlib";
import { writeFileSync } from "node:fs";
import { encodeGlb } from "./glb.mjs";

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}

function pngChunk(type, bytes) {
  const body = Buffer.concat([Buffer.from(type, "latin1"), bytes]);
  const chunk = Buffer.alloc(body.length + 8);
  chunk.writeUInt32BE(bytes.length, 0);
  body.copy(chunk, 4);
  chunk.writeUInt32BE(crc32(body), body.length + 4);
  return chunk;
}

/** A chequered picture of size x size pixels. */
function chequeredPng(size) {
  const rows = Buffer.alloc(size * (1 + 3 * size));
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x) rows.fill((x >> 3) + (y >> 3) & 1 ? 200 : 90, y * (1 + 3 * size) + 1 + 3 * x, y * (1 + 3 * size) + 4 + 3 * x);
  const head = Buffer.alloc(13);
  head.writeUInt32BE(size, 0);
  head.writeUInt32BE(size, 4);
  head.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), pngChunk("IHDR", head), pngChunk("IDAT", deflateSync(rows)), pngChunk("IEND", Buffer.alloc(0))]);
}

/** A surface of n x n quads: point(u, v) for u, v in [0, 1]. */
function surface(n, point) {
  const positions = [], uvs = [], indices = [];
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= n; ++i) {
      positions.push(...point(i / n, j / n));
      uvs.push(4 * i / n, 4 * j / n);
    }
  for (let j = 0; j < n; ++j)
    for (let i = 0; i < n; ++i) {
      const a = j * (n + 1) + i, b = a + n + 1;
      indices.push(a, b, a + 1, a + 1, b, b + 1);
    }
  return { positions, uvs, indices };
}

const sphere = (n, radius) =>
  surface(n, (u, v) => {
    const bumpy = radius * (1 - 0.05 * Math.cos(24 * Math.PI * u) * Math.sin(12 * Math.PI * v));
    const [a, e] = [2 * Math.PI * u, Math.PI * v];
    return [bumpy * Math.sin(e) * Math.cos(a), bumpy * Math.cos(e), bumpy * Math.sin(e) * Math.sin(a)];
  });
const ground = (side) => surface(4, (u, v) => [side * (v - 0.5), 0, side * (u - 0.5)]);
const house = (n, side, height) => surface(n, (u, v) => {
  const a = 2 * Math.PI * u, reach = side / 2 / Math.max(Math.abs(Math.cos(a)), Math.abs(Math.sin(a)));
  return [reach * Math.cos(a), height * (1 - v), reach * Math.sin(a)];
});

/** `shapes`: name -> surface; `nodes`: [shape, [x, y, z]]. */
function writeScene(file, shapes, nodes, textured) {
  const names = Object.keys(shapes), parts = [], views = [], accessors = [];
  let length = 0;
  const add = (bytes) => {
    const padded = Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);
    views.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
    length += padded.length;
    parts.push(padded);
    return views.length - 1;
  };
  const accessor = (array, type, componentType, components, bounds = {}) => {
    const bufferView = add(Buffer.from(array.buffer));
    return accessors.push({ bufferView, componentType, type, count: array.length / components, ...bounds }) - 1;
  };
  const meshes = names.map((name) => {
    const { positions, uvs, indices } = shapes[name];
    const axis = (k) => positions.filter((_, i) => i % 3 === k);
    const extreme = (pick) => [0, 1, 2].map((k) => Math.fround(axis(k).reduce((a, b) => pick(a, b))));
    const attributes = { POSITION: accessor(new Float32Array(positions), "VEC3", 5126, 3, { min: extreme(Math.min), max: extreme(Math.max) }) };
    if (textured) attributes.TEXCOORD_0 = accessor(new Float32Array(uvs), "VEC2", 5126, 2);
    return { name, primitives: [{ attributes, indices: accessor(new Uint32Array(indices), "SCALAR", 5125, 1), material: 0 }] };
  });
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: nodes.map((_, i) => i) }],
    nodes: nodes.map(([name, translation], i) => ({ name: `${name} ${i}`, mesh: names.indexOf(name), translation })),
    meshes, accessors, bufferViews: views, buffers: [{ byteLength: 0 }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.8, 0.7, 0.6, 1] }, doubleSided: true }],
  };
  if (textured) {
    json.images = [{ mimeType: "image/png", bufferView: add(chequeredPng(128)) }];
    json.textures = [{ source: 0 }];
    json.materials[0].pbrMetallicRoughness.baseColorTexture = { index: 0 };
  }
  json.buffers[0].byteLength = length;
  writeFileSync(file, encodeGlb(json, Buffer.concat(parts)));
}

const grid = (name, count, step, y) =>
  Array.from({ length: count * count }, (_, i) => [name, [step * ((i % count) - (count - 1) / 2), y, step * (Math.floor(i / count) - (count - 1) / 2)]]);

function writeConfig(file, boxes) {
  const corner = (point) => `[${point.map((value) => value.toFixed(3)).join(", ")}]`;
  const list = boxes.map(({ min, max }) => `{ min = ${corner(min)}, max = ${corner(max)} }`).join(", ");
  writeFileSync(file, `[view_space]\nkind = "boxes"\ninterval_deg = 22.5\nboxes = [${list}]\n[visibility]\nrays = 20000\n[select]\nsize_bakes = 8\n[survey]\nviews = 500\n[verify]\nviews = 4\n`);
  return file;
}

/**
 * Writes the scenes. Each: {name, scene, config, flags, stage and says (what its left_out entry must hold), inBudget (no view is slow)}.
 * `detail`: quads along a sphere.
 */
export function sixScenes(folder, detail = 24) {
  const file = (name) => join(folder, name);
  const slab = writeConfig(file("slab.toml"), [{ min: [-30, 1.6, -30], max: [30, 1.8, 30] }]);
  const spot = writeConfig(file("spot.toml"), [{ min: [-0.5, 1.5, -0.5], max: [0.5, 1.9, 0.5] }]);
  const tower = writeConfig(file("tower.toml"), [{ min: [-1, -15, -1], max: [1, 15, 1] }]);
  const fine = sphere(detail, 1.2);
  const field = { field: ground(160), sphere: fine }, onField = [["field", [0, 0, 0]], ...grid("sphere", 4, 36, 1.2)];
  writeScene(file("single.glb"), { sphere: sphere(4 * detail, 1) }, [["sphere", [0, 0, -30]]], true);
  writeScene(file("field.glb"), field, onField, true);
  writeScene(file("untextured.glb"), field, onField, false);
  writeScene(file("houses.glb"), { field: ground(160), house: house(detail, 12, 9), sphere: fine },
             [["field", [0, 0, 0]], ...grid("house", 4, 34, 0), ...grid("sphere", 5, 30, 1.2)], true);
  writeScene(file("far.glb"), { sphere: fine }, Array.from({ length: 12 }, (_, i) => ["sphere", [8 * i - 44, 1.7, -90 - (i % 3)]]), true);
  const job = (name, scene, config, stage, says, more = {}) => ({ name, scene: file(scene), config, stage, says, flags: [], ...more });
  return [
    job("a single object", "single.glb", tower, "visibility", /single object/, { flags: ["--split-extent", "0", "--split-triangles", "0"] }),
    job("no problem view", "field.glb", slab, "candidates", /no problem views/, { inBudget: true }),
    job("an open field without occlusion", "field.glb", slab, "visibility", /no occlusion to gain/),
    job("untextured", "untextured.glb", slab, "bake", /textures: no material/),
    job("a ground-level view space", "houses.glb", slab, "candidates", /vertical shafts/),
    job("one-layer clusters", "far.glb", spot, "bake", /one layer/),
  ];
}
