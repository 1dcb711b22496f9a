// What a scene does not need is left out, by name, and doing it all the same (--force all) gives the same placement, byte for byte.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { sixScenes } from "./six_scenes.mjs";
import { expectExit, readJson, resultOf, scratch, target } from "./standin.mjs";

const folder = scratch();

function flagsOf(job) {
  return [job.scene, "--target", target, "--config", job.config, "--quiet", ...job.flags];
}

/** Halfway between what is reachable and the highest bound; where no view is to be slow, above that. */
function budgetOf(job) {
  const survey = join(folder, `${job.name}-survey`);
  expectExit(0, "survey", ...flagsOf(job), "-o", survey);
  const { reachable_all_ms, worst_bound_ms } = readJson(join(survey, "metrics.json")).survey;
  if (job.inBudget) return (1.01 * worst_bound_ms).toFixed(4);
  assert.ok(reachable_all_ms < worst_bound_ms, `impostors help: ${reachable_all_ms} against ${worst_bound_ms} ms`);
  return (0.5 * (reachable_all_ms + worst_bound_ms)).toFixed(4);
}

const entries = (metrics, job) => metrics.left_out.filter((entry) => entry.stage === job.stage && job.says.test(entry.reason));

for (const job of sixScenes(folder))
  test(job.name, () => {
    const budget = budgetOf(job);
    const out = { normal: join(folder, `${job.name}-normal`), forced: join(folder, `${job.name}-forced`) };
    expectExit(0, "place", ...flagsOf(job), "--budget-ms", budget, "-o", out.normal);
    expectExit(0, "place", ...flagsOf(job), "--budget-ms", budget, "--force", "all", "-o", out.forced);
    const normal = resultOf(out.normal), forced = resultOf(out.forced);

    assert.equal(normal.metrics.cpv.count > 0, !job.inBudget);
    assert.equal(normal.metrics.impostors.count > 0, !job.inBudget);
    assert.equal(entries(normal.metrics, job).length, 1, JSON.stringify(normal.metrics.left_out));
    assert.deepEqual(forced.metrics.left_out, [], "nothing is left out where all is forced");
    for (const file of ["placement.json", "impostors.glb"])
      assert.ok(readFileSync(join(out.normal, file)).equals(readFileSync(join(out.forced, file))), `${file} differs`);
  });

test("a scene that needs a thing does not have it left out", () => {
  const left = (job) => resultOf(join(folder, `${job}-normal`)).metrics.left_out.map((entry) => entry.reason).join("; ");
  assert.doesNotMatch(left("a single object"), /textures: no material|vertical shafts/);
  assert.doesNotMatch(left("a ground-level view space"), /occlusion|textures: no material/);
});
