// Budgets no impostors can meet, and budgets that need none.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, fixture, readJson, resultOf, scratch, smallJob } from "./standin.mjs";

const folder = scratch();
const { survey } = readJson(join(fixture, "survey/metrics.json"));

function place(code, budget_ms, ...more) {
  const out = join(folder, budget_ms.toFixed(3));
  const run = expectExit(code, "place", city, ...smallJob, "--budget-ms", budget_ms.toFixed(3), "-o", out, ...more);
  return { ...run, ...resultOf(out), folder: out };
}

function expectExplained({ placement, metrics }) {
  const sum = (list) => list.reduce((total, entry) => total + entry.regions, 0);
  assert.equal(metrics.unsolved.length, Math.min(200, metrics.cpv.unsolved), "the worst are described");
  assert.equal(sum(metrics.unsolved_by_cell), metrics.cpv.unsolved, "all are counted, by place");
  assert.equal(sum(metrics.unsolved_by_object), metrics.cpv.unsolved, "and by cause");
  const lowest = metrics.unsolved.map((entry) => entry.lowest_budget_ms);
  assert.deepEqual(lowest, [...lowest].sort((a, b) => b - a), "worst first");
  assert.equal(lowest[0], Math.max(...metrics.unsolved_by_cell.map((cell) => cell.lowest_budget_ms)));
  for (const entry of metrics.unsolved) {
    const cpv = placement.cpvs[entry.cpv];
    assert.equal(cpv.solved, false);
    assert.equal(entry.bound_after_ms, cpv.bound_after_ms);
    assert.ok(entry.residual_ms > 0, `cpv ${entry.cpv}: residual ${entry.residual_ms}`);
    assert.ok(entry.lowest_budget_ms > placement.budget_ms, `cpv ${entry.cpv}: lowest budget ${entry.lowest_budget_ms}`);
    assert.ok(entry.blocking.length > 0 && entry.blocking.every((object) => placement.scene.objects[object.object].name === object.name));
  }
}

// What is reachable is drafted with cautious costs: real bakes may do a few per cent better.
test("a budget below what is reachable: the rest is solved, exit code 1", () => {
  const result = place(1, 0.9 * survey.reachable_all_ms);
  const { metrics, out } = result;
  assert.ok(metrics.cpv.unsolved > 0 && metrics.cpv.solved > metrics.cpv.unsolved, JSON.stringify(metrics.cpv));
  expectExplained(result);
  assert.ok(Math.max(...metrics.unsolved.map((entry) => entry.lowest_budget_ms)) <= survey.reachable_all_ms * (1 + 1e-9),
            "what survey called reachable for all");
  assert.match(out, /^unsolved: cpv \d+ \(cell .*\): .* ms, lowest budget .* ms, because of \S+/m);
  const report = JSON.parse(expectExit(1, "check", result.folder, "--json").out);
  assert.equal(report.violations, 0, "unsolved regions are no violation, but no success either");
});

test("half of what is reachable: everything is written, exit code 1", () => {
  const result = place(1, 0.5 * survey.reachable_all_ms, "--refine-levels", "0", "--leaf-m", "46");
  assert.ok(result.metrics.cpv.unsolved > 200, "enough for the list to be cut");
  expectExplained(result);
});

test("above the highest bound: no problem views, nothing to place, and it says so", () => {
  const { placement, metrics } = place(0, 1.001 * survey.worst_bound_ms);
  const { total_bytes, lods_bytes } = metrics.memory;  // without levels of detail the bound would be higher
  assert.deepEqual([placement.cpvs.length, placement.impostors.length, total_bytes - lods_bytes], [0, 0, 0]);
  assert.ok(metrics.left_out.some((entry) => /candidates/.test(entry.stage) && /no problem views/.test(entry.reason)),
            JSON.stringify(metrics.left_out));
});
