// Levels of detail: used where they save enough, shipped, checked; left out, by name, where they do not; a file's own are used as they are.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, readJson, resultOf, scratch, smallJob, source } from "./standin.mjs";

const folder = scratch();
const survey = (name, ...flags) => {
  expectExit(0, "survey", city, ...smallJob, ...flags, "-o", join(folder, name));
  return readJson(join(folder, name, "metrics.json"));
};
const without = survey("without", "--lods", "off");
const budget = (0.5 * (without.survey.reachable_all_ms + without.survey.worst_bound_ms)).toFixed(3);
const place = (name, ...flags) => {
  const out = join(folder, name);
  expectExit(0, "place", city, ...smallJob, "--budget-ms", budget, "--verify-views", "8", ...flags, "-o", out);
  return { out, ...resultOf(out) };
};
const placed = place("placed", "--lods", "on");

test("they lower what can be promised, with and without impostors", () => {
  const { survey, lods } = placed.metrics;
  assert.ok(lods.used && lods.objects > 0 && lods.saved_triangles_share > 0, JSON.stringify(lods));
  assert.ok(survey.worst_bound_ms < without.survey.worst_bound_ms, `${survey.worst_bound_ms} against ${without.survey.worst_bound_ms} ms`);
  assert.ok(survey.reachable_all_ms <= without.survey.reachable_all_ms, `${survey.reachable_all_ms} ms`);
});

test("placement.json names them, lods.glb holds them, and the schema and the Khronos validator find no fault", () => {
  const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true, allErrors: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const validate = ajv.compile(readJson(join(source, "configs/placement.schema.json")));
  assert.ok(validate(placed.placement), JSON.stringify(validate.errors?.slice(0, 5), null, 1));
  const file = join(placed.out, "lods.glb");
  const validator = spawnSync(process.execPath, [join(source, "tests/e2e/validate_glb.mjs"), file], { encoding: "utf8" });
  assert.equal(validator.status, 0, validator.stdout + validator.stderr);
  const bytes = readFileSync(file);
  const gltf = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
  const triangles = (node) => gltf.meshes[node.mesh].primitives.reduce((sum, p) => sum + gltf.accessors[p.indices].count / 3, 0);
  const nodes = new Map(gltf.nodes.map((node) => [node.name, node]));
  for (const { object, levels } of placed.placement.lods.objects) {
    assert.ok(object < placed.placement.scene.objects.length);
    levels.forEach((level, k) => {
      assert.equal(triangles(nodes.get(level.gltf_node)), level.triangles, level.gltf_node);
      if (k > 0) assert.ok(level.triangles < levels[k - 1].triangles && level.least_distance > levels[k - 1].least_distance);
    });
  }
});

test("verify states their image error, which is small", () => {
  const { image } = placed.metrics;
  assert.ok(image.lods_mean_error > 0 && image.lods_mean_error < 0.01, `${image.lods_mean_error}`);
  assert.ok(image.lods_mean_flip > 0 && image.lods_mean_flip < 0.05, `${image.lods_mean_flip}`);
});

test("check agrees; a level shown from nearer is found; another lods.glb is refused", () => {
  expectExit(0, "check", placed.out);
  const copy = join(folder, "tampered");
  cpSync(placed.out, copy, { recursive: true });
  const nearer = structuredClone(placed.placement);
  nearer.lods.objects[0].levels[0].least_distance *= 0.5;
  writeFileSync(join(copy, "placement.json"), JSON.stringify(nearer));
  const { findings } = JSON.parse(expectExit(1, "check", copy, "--json").out);
  assert.deepEqual([...new Set(findings.map((finding) => finding.violation))], ["levels"]);
  const glb = readFileSync(join(copy, "lods.glb"));
  glb[glb.length - 8] ^= 1;
  writeFileSync(join(copy, "lods.glb"), glb);
  assert.match(expectExit(2, "check", copy).err, /lods\.glb.*file_broken/);
});

test("where they would save little they are left out, and named", () => {
  const precise = survey("precise", "--lods", "auto", "--lods-error-px", "0.01");
  assert.equal(precise.lods.used, false);
  assert.ok(precise.left_out.some((entry) => entry.stage === "lods"), JSON.stringify(precise.left_out));
  assert.ok(!without.lods.used && without.left_out.every((entry) => entry.stage !== "lods"), "what is switched off is not left out");
});
