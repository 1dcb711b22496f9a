// Each baseline of configs/baselines is a plain configuration of the same program: it places, says what it did, and the same check scores it.
import assert from "node:assert/strict";
import { readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { city, placed, readJson, resultOf, scratch, source, standin, target } from "./standin.mjs";

const folder = scratch();
const ours = resultOf(placed);
// A baseline's file takes the place of the fixture's, so its settings are flags here; cells are not halved and lower bounds hardly sought, to save seconds.
const small = ["--target", target, "--refine-levels", "0", "--interval-deg", "22.5", "--visibility-rays", "20000", "--survey-views", "500",
               "--verify-views", "0", "--size-bakes", "8", "--guided-sweeps", "0", "--bound-iterations", "10", "--quiet"];
const baselines = readdirSync(join(source, "configs/baselines")).sort();

/** Places under the baseline; what is not met is written all the same. */
function place(file, ...more) {
  const out = join(folder, file);
  const budget = ["--budget-ms", String(ours.metrics.budget_ms)];
  const { code, err } = standin("place", city, ...small, ...budget, "--config", join(source, "configs/baselines", file), ...more, "-o", out);
  const result = resultOf(out);
  assert.equal(code, result.metrics.cpv.unsolved > 0 ? 1 : 0, err);
  return { ...result, check: JSON.parse(standin("check", out, "--json").out) };
}

const results = Object.fromEntries(baselines.map((file) => [file, place(file)]));
const kinds = ({ placement }) => new Set(placement.impostors.map((impostor) => impostor.view_cell.kind));

test("all are there", () => assert.deepEqual(baselines, ["no_visibility.toml", "per_cell.toml", "rectangular.toml", "thesis.toml"]));

for (const file of baselines)
  test(`${file}: the same check finds nothing wrong`, () => {
    const { check, metrics, placement } = results[file];
    assert.equal(check.violations, 0);
    assert.equal(check.texture_bytes, metrics.memory.texture_bytes);
    assert.ok(placement.impostors.length > 0 && metrics.cpv.solved > 0, JSON.stringify(metrics.cpv));
  });

test("rectangular and per-cell placements have boxes; a per-cell one lies in one leaf", () => {
  assert.deepEqual(kinds(results["rectangular.toml"]), new Set(["box"]));
  assert.deepEqual(kinds(results["per_cell.toml"]), new Set(["box"]));
  const leaf = readJson(join(placed, "placement.json")).spec.view_space.leaf_m;
  for (const { view_cell } of results["per_cell.toml"].placement.impostors)
    for (const axis of [0, 1, 2]) assert.ok(view_cell.max[axis] - view_cell.min[axis] <= leaf * (1 + 1e-9));
});

test("the thesis' shafts have its apex angles and begin at powers of two", () => {
  const { placement } = results["thesis.toml"];
  const tangents = placement.spec.candidates.apex_deg.map((apex) => Math.tan((apex * Math.PI) / 360));
  for (const { view_cell } of placement.impostors) {
    assert.equal(view_cell.kind, "shaft");
    for (const tangent of view_cell.tan_half)
      assert.ok(tangents.some((known) => Math.abs(known - tangent) < 1e-9 * known), `tan_half ${view_cell.tan_half}`);
  }
});

test("the thesis' bounds are the looser ones", () => {
  assert.ok(results["thesis.toml"].metrics.survey.worst_bound_ms > ours.metrics.survey.worst_bound_ms);
});

// Some steps around the slowest view: every cell samples thousands of views.
test("sampled views say that they promise nothing, and the same check finds nothing wrong", () => {
  const out = join(folder, "sampled"), path = join(folder, "path.csv"), [slowest] = ours.metrics.survey.worst_views;
  writeFileSync(path, `${slowest.position.join(",")}\n`);
  const flags = [...small.filter((word) => word !== "--quiet"), "--view-space", `path:${path}`, "--size-bakes", "2"];
  const { out: text } = standin("place", city, ...flags, "--budget-ms", String(0.9 * slowest.frame_ms), "--region-bounds", "view", "-o", out);
  const { metrics, placement } = resultOf(out);
  assert.equal(metrics.mode, "sampled");
  assert.match(text, /nothing is promised/);
  assert.equal(placement.spec.view_space.bounds, "view");
  assert.ok(metrics.cpv.count > 0);
  assert.equal(JSON.parse(standin("check", out, "--json").out).violations, 0);
});

for (const command of ["survey", "sweep"])
  test(`${command} says what can be promised, so it refuses sampled views`, () => {
    const { code, err } = standin(command, city, "--target", target, "--region-bounds", "view", "-o", join(folder, "refused"));
    assert.equal(code, 2);
    assert.match(err, /--region-bounds view violates: sample or object/);
  });
