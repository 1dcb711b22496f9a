// The fixture of all other tests: a small city, surveyed, and placed with a budget a little above what the survey called reachable.
import assert from "node:assert/strict";
import { mkdirSync, readdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, fixture, placed, readJson, resultOf, smallJob } from "./standin.mjs";

rmSync(fixture, { recursive: true, force: true });
mkdirSync(fixture, { recursive: true });

test("make-city writes as many objects and triangles as asked", () => {
  expectExit(0, "make-city", "--objects", "150", "--triangles", "150000", "--seed", "1", "-o", city);
  const info = JSON.parse(expectExit(0, "info", city, "--json").out);
  assert.equal(info.objects, 150);
  assert.ok(Math.abs(info.triangles - 150000) <= 1500, `${info.triangles} triangles`);
  assert.equal(info.default_view_space.kind, "walk");
});

test("survey says how low the budget may go, and place gets there", () => {
  expectExit(0, "survey", city, ...smallJob, "-o", join(fixture, "survey"));
  const { survey } = readJson(join(fixture, "survey/metrics.json"));
  assert.ok(survey.reachable_all_ms < survey.worst_bound_ms, "impostors help this city");
  const slowest = survey.worst_views.map((view) => view.frame_ms);
  assert.deepEqual(slowest, [...slowest].sort((a, b) => b - a), "slowest first");
  assert.equal(slowest[0], survey.worst_frame_ms);
  assert.ok(survey.reachable_p90_ms <= survey.reachable_p99_ms && survey.reachable_p99_ms <= survey.reachable_all_ms);

  const budget = (1.05 * survey.reachable_all_ms).toFixed(3);
  expectExit(0, "place", city, ...smallJob, "--threads", "2", "--budget-ms", budget, "-o", placed);
  const { metrics } = resultOf(placed);
  assert.ok(metrics.cpv.count > 0 && metrics.impostors.count > 0, "there is something to place");
  assert.equal(metrics.cpv.solved, metrics.cpv.count);
  assert.equal(metrics.survey.worst_bound_ms, survey.worst_bound_ms);
  // A cell that only one of the two halves may show coarser levels of detail there.
  for (const key of ["p50_frame_ms", "p90_frame_ms", "p99_frame_ms"])
    assert.ok(Math.abs(metrics.survey[key] / survey[key] - 1) < 0.02, `${key}: ${metrics.survey[key]} in place, ${survey[key]} in survey`);
});

test("the result's files are there, and no staged one", () => {
  assert.deepEqual(readdirSync(placed).filter((name) => !name.startsWith(".")).sort(),
                   ["impostors.glb", ...(resultOf(placed).placement.lods ? ["lods.glb"] : []), "metrics.json", "placement.json", "report.html", ...resultOf(placed).metrics.verify.pictures.map(({ file }) => file)]);
  assert.ok(resultOf(placed).metrics.verify.pictures.length > 0);
  assert.deepEqual(readdirSync(fixture).sort(), ["city.glb", "placed", "survey"]);
});
