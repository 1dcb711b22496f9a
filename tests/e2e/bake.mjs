// `bake`: one impostor with its files, its cost and what the written file is worth.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, readJson, scratch } from "./standin.mjs";

const folder = scratch();
const cellOf = (flags) => (flags.includes("--view-cell") ? [] : ["--view-cell", "shaft:1,0.2,0,30,300"]);
const bake = (name, ...more) => {
  const out = join(folder, name);
  const printed = JSON.parse(expectExit(0, "bake", city, "--objects", "2", "--quiet", "-o", out, ...cellOf(more), ...more).out);
  assert.deepEqual(printed, readJson(join(out, "metrics.json")), "what is printed is what is written");
  return { out, metrics: printed };
};
const isCount = (value) => Number.isInteger(value) && value >= 0;
const isShare = (value) => value >= 0 && value <= 1;

test("an impostor is judged on its file, under each sampling", () => {
  const { out, metrics } = bake("one", "--views", "8");
  assert.deepEqual(readdirSync(out).filter((name) => !name.startsWith(".")).sort(), ["impostors.glb", "metrics.json"]);
  assert.equal(metrics.technique, "layered");
  assert.equal(metrics.triangles, 2 * metrics.quads);
  const { image } = metrics;
  assert.equal(image.views, 8);
  assert.equal(image.gap_pixels, 0);
  assert.ok(image.judged_pixels > 0 && image.max_parallax_ratio > 0 && image.max_parallax_ratio <= 1);
  for (const errors of [image, image.at_reference]) assert.ok(isShare(errors.mean_error) && isShare(errors.mean_flip) && errors.mean_flip > 0);
  assert.deepEqual(Object.keys(image.samplings).sort(), ["bilinear", "mipmapped", "nearest"]);
  for (const sampling of Object.values(image.samplings)) assert.ok(isCount(sampling.gap_pixels) && sampling.silhouette_bloat_px >= 0);
  assert.deepEqual(image.samplings.nearest, { gap_pixels: image.gap_pixels, silhouette_bloat_px: image.silhouette_bloat_px });
});

const timeless = (metrics) => JSON.parse(JSON.stringify(metrics, (key, value) => (key === "seconds" ? undefined : value)));

test("the same whatever the thread count; other views with another seed", () => {
  const one = timeless(bake("threads1", "--views", "8", "--threads", "1").metrics);
  assert.deepEqual(timeless(bake("threads3", "--views", "8", "--threads", "3").metrics), one);
  assert.notDeepEqual(bake("seed", "--views", "8", "--seed", "9").metrics.image, one.image);
});

test("without views the image metrics are left out", () => {
  assert.equal(bake("blind", "--views", "0").metrics.image, null);
});

test("a depth mesh is smaller, is read back from its file, and promises nothing", () => {
  const near = ["--views", "8", "--view-cell", "shaft:1,0.2,0,30,200"];
  const layered = bake("near", ...near).metrics;
  const mesh = bake("mesh", "--technique", "tdm", ...near).metrics;
  assert.deepEqual([layered.guarantee, mesh.guarantee], ["nearest", "none"]);
  assert.ok(layered.layers > 1 && mesh.layers === layered.layers);
  assert.ok(mesh.triangles > 2 && mesh.quads === 0);
  assert.ok(mesh.texture_bytes < layered.texture_bytes, `${mesh.texture_bytes} bytes of ${layered.texture_bytes}`);
  assert.ok(mesh.image.judged_pixels > 1000 && mesh.image.gap_pixels < 1e-3 * mesh.image.judged_pixels);
});

test("a planar impostor is the one layer that is enough from afar, and is refused where it is not", () => {
  const far = ["--views", "8", "--view-cell", "shaft:1,0.2,0,2,3000"];
  const layered = bake("far", ...far).metrics;
  const planar = bake("planar", "--technique", "planar", ...far).metrics;
  assert.deepEqual([planar.technique, planar.guarantee, planar.layers], ["planar", "nearest", 1]);
  assert.deepEqual(planar.image, layered.image);
  assert.equal(planar.texture_bytes, layered.texture_bytes);
  const near = ["--view-cell", "shaft:1,0.2,0,30,200", "--technique", "planar", "-o", join(folder, "refused")];
  const { err } = expectExit(2, "bake", city, "--objects", "2", "--quiet", ...near);
  assert.match(err, /needs \d+ layers; a planar impostor has one/);
});

test("a LOD-sprite is a coarse mesh, read back from its file, that promises nothing", () => {
  const near = ["--views", "8", "--view-cell", "shaft:1,0.2,0,30,200"];
  const sprite = bake("sprite", "--technique", "lod-sprite", ...near).metrics;
  assert.deepEqual([sprite.technique, sprite.guarantee, sprite.quads], ["lod-sprite", "none", 0]);
  assert.ok(sprite.triangles > 2 && sprite.texture_bytes > 0);
  assert.ok(sprite.image.judged_pixels > 1000 && sprite.image.gap_pixels < 1e-2 * sprite.image.judged_pixels, `${sprite.image.gap_pixels} gaps`);
});
