// What `place` wrote keeps the contracts: schemas, the Khronos validator, the fields of metrics.json, a page that needs no network.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { at, expectExit, placed, readJson, resultOf, source } from "./standin.mjs";

const require = createRequire(import.meta.url);
const { placement, metrics } = resultOf(placed);

const kMetrics = `
  scene.objects scene.triangles budget_ms cpv.count cpv.solved cpv.unsolved candidates.generated candidates.pruned impostors.count
  memory.texture_bytes memory.geometry_bytes memory.lods_bytes memory.total_bytes memory.atlas_padding_bytes bound.memory_lower_bound_bytes
  survey.worst_frame_ms survey.p99_frame_ms survey.worst_bound_ms
  verify.views verify.over_budget_estimated image.views image.gap_pixels image.max_parallax_ratio image.silhouette_bloat_px image.mean_error image.mean_flip
  stages_s.load stages_s.visibility stages_s.view_space stages_s.candidates stages_s.select stages_s.bake stages_s.verify
  peak_rss_bytes`.trim().split(/\s+/);

function* leaves(value, path = "") {
  if (value !== null && typeof value === "object")
    for (const [key, inner] of Object.entries(value)) yield* leaves(inner, path ? `${path}.${key}` : key);
  else yield [path, value];
}

test("placement.json is what configs/placement.schema.json says", () => {
  const Ajv = require("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true, allErrors: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const validate = ajv.compile(readJson(join(source, "configs/placement.schema.json")));
  assert.ok(validate(placement), JSON.stringify(validate.errors?.slice(0, 5), null, 1));
  for (const [name, spoil] of Object.entries({
    "a missing budget": (p) => delete p.budget_ms,
    "a face of its own": (p) => (p.intervals[0].face = "up"),
    "an unknown technique": (p) => (p.impostors[0].technique = "magic"),
    "a path in the spec": (p) => (p.spec.texture_folder = "/home"),
  })) {
    const spoilt = structuredClone(placement);
    spoil(spoilt);
    assert.ok(!validate(spoilt), `the schema accepts ${name}`);
  }
});

test("cells, intervals and impostors are referred to by index, and cover what they must", () => {
  placement.impostors.forEach((impostor, id) => assert.equal(impostor.id, id));
  for (const cpv of placement.cpvs) {
    assert.ok(cpv.bound_before_ms > placement.budget_ms, "a CPV is over budget without impostors");
    assert.equal(cpv.solved, cpv.bound_after_ms <= placement.budget_ms);
    const objects = cpv.impostors.flatMap((id) => placement.impostors[id].objects);
    assert.equal(new Set(objects).size, objects.length, "impostors of a CPV stand for disjoint objects");
  }
  const used = new Set(placement.cpvs.flatMap((cpv) => cpv.impostors));
  assert.equal(used.size, placement.impostors.length, "every impostor is drawn by some CPV");
});

test("check agrees", () => {
  const report = JSON.parse(expectExit(0, "check", placed, "--json").out);
  assert.equal(report.violations, 0);
  assert.equal(report.solved, metrics.cpv.count);
  assert.equal(report.texture_bytes, metrics.memory.texture_bytes);
});

test("the Khronos validator finds no error in impostors.glb, and every impostor has its node", () => {
  const file = join(placed, "impostors.glb");
  const validator = spawnSync(process.execPath, [join(source, "tests/e2e/validate_glb.mjs"), file], { encoding: "utf8" });
  assert.equal(validator.status, 0, validator.stdout + validator.stderr);
  const bytes = new Uint8Array(readFileSync(file));
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + new DataView(bytes.buffer).getUint32(12, true))));
  const names = new Set(json.nodes.map((node) => node.name));
  for (const impostor of placement.impostors) assert.ok(names.has(impostor.gltf_node), impostor.gltf_node);
  for (const material of json.materials) assert.equal(material.alphaMode, "MASK");
});

test("metrics.json has its fields, all numbers are finite, and sums add up", () => {
  for (const path of kMetrics) assert.equal(typeof at(metrics, path), "number", path);
  for (const path of ["survey.reachable_all_ms", "survey.reachable_p99_ms", "survey.reachable_p90_ms"])
    assert.equal(at(metrics, path), null, `${path}: the survey's to say`);
  assert.ok(metrics.left_out.some(({ stage, reason }) => stage === "survey" && /how low another budget/.test(reason)));
  assert.ok(metrics.bound.gap >= 0 && metrics.bound.gap <= 1, `bound.gap ${metrics.bound.gap}`);
  for (const path of ["verify.over_budget_measured", "verify.frame_ms_before.p50", "verify.frame_ms_before.p99", "verify.frame_ms_before.max",
                      "verify.frame_ms_after.p50", "verify.frame_ms_after.p99", "verify.frame_ms_after.max"])
    assert.notEqual(at(metrics, path), undefined, path);
  assert.ok(Array.isArray(metrics.left_out));
  // JSON has no NaN; a writer that met one leaves a null, so nulls may stand only for what was not measured, or for no CPV.
  for (const [path, value] of leaves(metrics))
    if (value === null) assert.match(path, /^survey\.reachable_|^verify\.(over_budget_measured|worst_over_budget|measured_coverage|worst_before_over_surveyed|frame_ms_|frames\.)/, `${path} is null`);
  assert.equal(metrics.memory.texture_bytes + metrics.memory.geometry_bytes + metrics.memory.lods_bytes, metrics.memory.total_bytes);
  assert.equal(metrics.cpv.solved + metrics.cpv.unsolved, metrics.cpv.count);
  assert.equal(metrics.mode, "certified");
  assert.ok(metrics.bound.memory_lower_bound_bytes <= metrics.memory.texture_bytes);
  assert.equal(placement.impostors.reduce((sum, impostor) => sum + impostor.texture_bytes, 0), metrics.memory.texture_bytes);
});

// Width and height of each atlas page, from the header of its PNG.
function atlasSizes() {
  const glb = readFileSync(join(placed, "impostors.glb"));
  const jsonLength = glb.readUInt32LE(12);
  const gltf = JSON.parse(glb.subarray(20, 20 + jsonLength));
  return gltf.images.map((image) => {
    const png = 20 + jsonLength + 8 + (gltf.bufferViews[image.bufferView].byteOffset ?? 0);
    return [glb.readUInt32BE(png + 16), glb.readUInt32BE(png + 20)];
  });
}

test("curves of error against run time, and the atlases' bytes in GPU formats", () => {
  for (const name of ["visibility", "view_space", "select", "bake_rounds", "bake"]) {
    const curve = metrics.curves[name];
    assert.ok(Array.isArray(curve) && (curve.length > 0 || name === "visibility"), name);
    for (const { seconds, work, error, unit } of curve)
      assert.ok(seconds >= 0 && work > 0 && error >= 0 && unit.length > 0, `${name}: ${JSON.stringify(curve)}`);
  }
  const errors = (name) => metrics.curves[name].map((point) => point.error);
  const falls = (list) => list.every((value, i) => i === 0 || value <= list[i - 1]);
  for (const name of ["view_space", "select", "bake"]) assert.ok(falls(errors(name)), `${name}: more time, less error`);
  assert.deepEqual(metrics.curves.select.map(({ step }) => step), ["greedy", "reverse-delete", "second greedy"], "of the first selection alone");
  for (const key of ["seconds", "work"]) assert.ok(falls(metrics.curves.select.map((point) => -point[key])), `${key} never fall`);
  assert.ok(errors("select").every((gap) => gap < 1), "the bound is above zero");
  const last = metrics.curves.bake.at(-1);
  assert.ok(Math.abs(last.work - metrics.memory.texture_bytes) < 1e-6 * last.work, "the finest bake is the one that ships");
  assert.equal(metrics.curves.bake_rounds.at(-1).error, metrics.memory.texture_bytes);

  const { rgba8, bc1, bc3, bc7, etc2_rgb8a1, etc2_rgba8 } = metrics.memory.gpu_bytes;
  assert.equal(rgba8, atlasSizes().reduce((sum, [width, height]) => sum + 4 * width * height, 0));
  assert.equal(rgba8, metrics.memory.texture_bytes + metrics.memory.atlas_padding_bytes);
  assert.deepEqual([bc3, bc7, etc2_rgb8a1, etc2_rgba8], [2 * bc1, 2 * bc1, bc1, 2 * bc1]);
  const blocks = atlasSizes().map(([width, height]) => Math.ceil(width / 4) * Math.ceil(height / 4));
  assert.equal(bc7, 16 * blocks.reduce((sum, count) => sum + count, 0), "16 bytes a block of 4 x 4 texels");
  for (const format of ["bc1", "bc3"]) {
    const { alpha_exact, alpha_changed_texels, opaque_psnr_db, mean_error, seconds } = metrics.memory.gpu_compression[format];
    assert.deepEqual([alpha_exact, alpha_changed_texels], [true, 0], `${format}: no hole, no fin`);
    assert.ok(opaque_psnr_db > 25 && mean_error > 0 && mean_error < 0.05 && seconds > 0, `${format}: ${opaque_psnr_db} dB, ${mean_error}`);
  }
});

test("images keep their guarantee", () => {
  assert.equal(metrics.image.gap_pixels, 0);
  assert.ok(metrics.image.max_parallax_ratio <= 1);
  assert.equal(metrics.verify.over_budget_estimated, 0);
});

test("report.html loads nothing from elsewhere", () => {
  const page = readFileSync(join(placed, "report.html"), "utf8");
  const markup = page.replace(/(<(?:script|style)\b[^>]*>)[^]*?(<\/(?:script|style)>)/g, "$1$2");
  const sources = [...markup.matchAll(/<[a-z]+\b[^>]*?\s(?:src|href)\s*=\s*["']?([^"'\s>]*)/gi)].map((match) => match[1]);
  assert.deepEqual(sources.filter((address) => !/^(data:|#)/.test(address)), []);
  assert.doesNotMatch(page, /@import|url\(\s*["']?https?:/i);
});
