// The optional step to GPU-compressed textures: what comes out is a GLB that engines read, with every mask as it was.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { readGlb, viewBytes } from "../../server/ktx2/glb.mjs";
import { decodePng } from "../../server/ktx2/png.mjs";
import { loss } from "../../server/ktx2/to_ktx2.mjs";
import { placed, readJson, scratch, source } from "./standin.mjs";

const folder = scratch();
const original = join(placed, "impostors.glb");
const converted = join(folder, "impostors.ktx2.glb");

function toKtx2(...args) {
  return spawnSync(process.execPath, [join(source, "server/ktx2/to_ktx2.mjs"), ...args], { encoding: "utf8" });
}

const run = toKtx2(original, converted, "--quality", "0");
const pages = ({ gltf, binary }) => gltf.images.map((image) => viewBytes({ gltf, binary }, image.bufferView));

test("pages become KTX2 files of one level, which textures refer to", () => {
  assert.equal(run.status, 0, run.stderr);
  const before = readGlb(readFileSync(original)), after = readGlb(readFileSync(converted));
  for (const list of ["extensionsUsed", "extensionsRequired"]) assert.ok(after.gltf[list].includes("KHR_texture_basisu"));
  after.gltf.textures.forEach((texture, i) => {
    assert.equal(texture.source, undefined);
    assert.equal(texture.extensions.KHR_texture_basisu.source, before.gltf.textures[i].source);
  });
  pages(after).forEach((ktx2, i) => {
    const png = decodePng(pages(before)[i]);
    assert.equal(ktx2.toString("latin1", 1, 7), "KTX 20");
    const [vkFormat, , width, height, , , faces, levels] = Array.from({ length: 8 }, (_, k) => ktx2.readUInt32LE(12 + 4 * k));
    assert.deepEqual([vkFormat, width, height, faces, levels], [0, png.width, png.height, 1, 1]);
    assert.equal(after.gltf.images[i].mimeType, "image/ktx2");
  });
});

test("everything but the pages is as it was", () => {
  const before = readGlb(readFileSync(original)), after = readGlb(readFileSync(converted));
  const images = new Set(before.gltf.images.map((image) => image.bufferView));
  before.gltf.bufferViews.forEach((_, i) => images.has(i) || assert.deepEqual(viewBytes(after, i), viewBytes(before, i), `buffer view ${i}`));
  assert.deepEqual(after.gltf.nodes, before.gltf.nodes);
  assert.deepEqual(after.gltf.accessors, before.gltf.accessors);
});

test("the report states exact masks, the colours' loss and the bytes that metrics.json foretold", () => {
  const report = JSON.parse(run.stdout), memory = readJson(join(placed, "metrics.json")).memory;
  assert.equal(report.alpha_exact, true);
  assert.ok(report.opaque_psnr_db > 25 && report.seconds > 0);
  assert.equal(report.gpu_bytes, memory.gpu_bytes.bc7);
});

test("a changed mask is found, an unseen colour is not", () => {
  const texels = new Uint8Array([10, 20, 30, 255, 1, 2, 3, 0]);
  assert.deepEqual(loss(texels, texels), { opaque: 1, alphaChanges: 0, squaredError: 0 });
  assert.deepEqual(loss(texels, new Uint8Array([10, 24, 33, 128, 99, 99, 99, 127])), { opaque: 1, alphaChanges: 0, squaredError: 25 });
  assert.equal(loss(texels, new Uint8Array([10, 20, 30, 127, 1, 2, 3, 128])).alphaChanges, 2);
});

test("what is no impostor file is refused, and nothing is left behind", () => {
  const broken = join(folder, "broken.glb"), out = join(folder, "never.glb");
  writeFileSync(broken, "glTF");
  assert.equal(toKtx2(broken, out).status, 1);
  assert.equal(toKtx2(original, out, "--quality", "9").status, 2);
  assert.equal(toKtx2(original).status, 2);
  assert.ok(!existsSync(out) && !existsSync(`${out}.part`));
});
