// The curve of memory against the budget, and the gates it is held against, on a small city.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { expectExit, readJson, resultOf, scratch, source, start, target, tracesOf } from "./standin.mjs";

const folder = scratch();
const city = join(folder, "city.glb");
expectExit(0, "make-city", "--objects", "60", "--triangles", "60000", "--seed", "3", "-o", city);

const job = ["--target", target, "--config", join(source, "tests/e2e/small.toml"), "--refine-levels", "1", "--size-bakes", "6"];
const out = (name) => join(folder, name);
const sweepArgs = (name, ...more) => ["sweep", city, ...job, "--quiet", "-o", out(name), ...more];
const sweep = (code, name, ...more) => ({ ...expectExit(code, ...sweepArgs(name, ...more)), sweep: readJson(join(out(name), "sweep.json")) });
const text = (name, content) => (writeFileSync(out(name), content), out(name));
const changed = (name, change) => {
  const object = structuredClone(first.sweep);
  change(object);
  return text(name, JSON.stringify(object));
};
const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
const ajv = new Ajv({ strict: true, allErrors: true });
ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
const schema = (name) => ajv.compile(readJson(join(source, `configs/${name}.schema.json`)));
const isSweep = schema("sweep"), isAcceptance = schema("acceptance");
const expectSweep = (object) => assert.ok(isSweep(object), JSON.stringify(isSweep.errors?.slice(0, 5), null, 1));
const sha256 = (bytes) => createHash("sha256").update(bytes).digest("hex");

const first = sweep(0, "first");
const { points, survey } = first.sweep;
const budgets = points.map((point) => point.budget_ms);
const some = ["--budgets-ms", `${budgets[8]},${budgets[0]}`];

test("ten budgets are chosen between reachable and needless, and it says so", () => {
  assert.equal(points.length, 10);
  assert.ok(survey.reachable_all_ms < budgets[0] && budgets[9] < survey.worst_bound_ms, `${budgets}`);
  assert.match(first.out, /^budgets: 10 budgets, evenly between the lowest reachable one \(.* ms\) and the highest bound of a region \(.* ms\)$/m);
  assert.deepEqual(readdirSync(out("first")).filter((name) => !name.startsWith(".")).sort(), ["report.html", "sweep.json"]);
});

test("sweep.json is what its schema says, and report writes the page again", () => {
  expectSweep(first.sweep);
  for (const spoil of [(s) => delete s.points[0].texture_bytes, (s) => (s.points[2].impostors = -1), (s) => (s.path = "/home")]) {
    const spoilt = structuredClone(first.sweep);
    spoil(spoilt);
    assert.ok(!isSweep(spoilt), `the schema accepts ${spoil}`);
  }
  const page = readFileSync(join(out("first"), "report.html"), "utf8");
  rmSync(join(out("first"), "report.html"));
  expectExit(0, "report", out("first"));
  assert.equal(readFileSync(join(out("first"), "report.html"), "utf8"), page);
});

// Step by step the curve may rise: what a greedy finds at a looser budget may be worse than what it found at a tighter one.
test("the curve falls: every budget met, fewer slow regions at a looser one, and never more memory than at all tighter ones", () => {
  for (const [i, point] of points.entries()) {
    assert.ok(point.met && point.reachable && point.cpv.unsolved === 0 && point.cpv.count > 0, JSON.stringify(point));
    assert.ok(point.memory_lower_bound_bytes <= point.texture_bytes && point.gap >= 0 && point.seconds > 0, JSON.stringify(point));
    assert.equal(point.total_bytes, point.texture_bytes + point.geometry_bytes + point.lods_bytes);
    if (i === 0) continue;
    const tighter = Math.max(...points.slice(0, i).map((earlier) => earlier.texture_bytes));
    assert.ok(point.texture_bytes <= tighter, `${point.budget_ms} ms takes ${point.texture_bytes} bytes, all tighter ones at most ${tighter}`);
    assert.ok(point.cpv.count <= points[i - 1].cpv.count);
  }
  assert.ok(points[9].texture_bytes < 0.5 * points[0].texture_bytes, "and by more than a little");
  assert.ok(points.some((point) => point.bakes.recalled > 0), "bakes were shared");
});

test("it is what place gives at each budget, to the byte", () => {
  for (const point of [points[0], points[6]]) {
    const folder = out(`placed-${point.budget_ms}`);
    expectExit(0, "place", city, ...job, "--quiet", "--verify-views", "1", "--budget-ms", String(point.budget_ms), "-o", folder);
    assert.equal(sha256(readFileSync(join(folder, "placement.json"))), point.placement_sha256);
    assert.equal(sha256(readFileSync(join(folder, "impostors.glb"))), point.impostors_sha256);
    const { metrics } = resultOf(folder);
    assert.deepEqual(
      [metrics.cpv, metrics.impostors.count, metrics.memory.texture_bytes, metrics.memory.total_bytes, metrics.bound.memory_lower_bound_bytes, metrics.bound.gap],
      [point.cpv, point.impostors, point.texture_bytes, point.total_bytes, point.memory_lower_bound_bytes, point.gap]);
  }
});

test("the gate passes against its own baseline, at its budgets, and against met criteria", () => {
  const id = first.sweep.target.id;
  const criteria = [{ target: id, budget_ms: budgets[0], max_total_bytes: points[0].total_bytes, max_unsolved: 0 }, { target: "another machine", budget_ms: 1 }];
  const baseline = changed("own.json", (object) => (object.points = [object.points[0], object.points[8]]));
  assert.ok(isAcceptance(criteria) && !isAcceptance([{ ...criteria[0], max: 1 }]));
  const run = sweep(0, "own", "--baseline", baseline, "--tolerance", "0", "--acceptance", text("met.json", JSON.stringify(criteria)));
  expectSweep(run.sweep);
  assert.deepEqual(run.sweep.points.map((point) => point.budget_ms), [budgets[0], budgets[8]]);
  assert.deepEqual([run.sweep.passed, run.sweep.baseline.regressions, run.sweep.acceptance.length], [true, [], 1]);
  assert.match(run.out, /^2 budgets compared with the baseline, 0 worse$/m);
  assert.match(run.out, /^criterion at .* ms: passed$/m);
});

test("the gate fails against a better baseline, names budget, before and after, and criteria fail by themselves", () => {
  const less = Math.floor(points[0].texture_bytes / 1.03);
  const better = changed("better.json", (object) => (object.points[0].texture_bytes = less));
  const id = first.sweep.target.id;
  const criteria = [{ target: id, budget_ms: budgets[8], max_total_bytes: 1 }];
  const run = sweep(1, "worse", ...some, "--baseline", better, "--acceptance", text("unmet.json", JSON.stringify(criteria)));
  expectSweep(run.sweep);
  assert.deepEqual(run.sweep.baseline.regressions.map((one) => [one.budget_ms, one.kind, one.before, one.after]),
                   [[budgets[0], "memory", less, points[0].texture_bytes]]);
  assert.ok(run.out.includes(`worse than the baseline at ${budgets[0]} ms: ${less} bytes of texture before, ${points[0].texture_bytes} now (+3`), run.out);
  assert.deepEqual(run.sweep.acceptance.map((one) => one.passed), [false]);
  assert.equal(run.sweep.passed, false);
});

test("a budget that cannot be met fails, unless the baseline could not meet it either", () => {
  const impossible = 0.9 * survey.reachable_all_ms;
  const run = sweep(1, "unmet", "--budgets-ms", `${impossible}`);
  const [point] = run.sweep.points;
  expectSweep(run.sweep);
  assert.ok(point.unsolved_by_object.length > 0 && point.unsolved_by_object[0].regions > 0, "what is in the way is named");
  assert.ok(!point.met && !point.reachable && point.cpv.unsolved > 0, JSON.stringify(point));
  assert.match(run.out, /^not met: /m);
  const unmetBefore = text("unmet-before.json", JSON.stringify(run.sweep));
  assert.equal(sweep(0, "unmet-again", "--baseline", unmetBefore).sweep.passed, true);
});

// What, flags, error word, what the sentence must name; refused before any work is done.
const kRefused = [
  ["a baseline that is not there", ["--baseline", "nowhere.json"], "file_missing", /nowhere\.json/],
  ["a baseline that is no JSON", ["--baseline", text("prose.json", "once")], "file_broken", /prose\.json is not JSON/],
  ["a baseline cut short", ["--baseline", changed("cut.json", (object) => delete object.points[3].texture_bytes)], "file_broken", /cut\.json: points\[3\] lacks "texture_bytes"/],
  ["metrics for a baseline", ["--baseline", text("metrics.json", "{}")], "file_broken", /metrics\.json lacks "format"/],
  ["another scene's baseline", ["--baseline", changed("scene.json", (object) => (object.scene.name = "town.glb"))], "bad_usage", /another scene: town\.glb/],
  ["another target's baseline", ["--baseline", changed("target.json", (object) => (object.target.id = "radeon"))], "bad_usage", /another target: radeon/],
  ["another camera's baseline", ["--baseline", out("first/sweep.json"), "--width", "640"], "bad_usage", /another camera: 512 x 512/],
  ["a baseline of other budgets", ["--baseline", out("first/sweep.json"), "--budgets-ms", "1"], "bad_usage", /none of this sweep's budgets/],
  ["criteria of no known key", ["--acceptance", text("key.json", '[{"target": "t", "budget_ms": 1, "max": 3}]')], "bad_config", /key\.json: \[0\]\.max = 3/],
  ["criteria for other targets alone", ["--acceptance", text("other.json", '[{"target": "t", "budget_ms": 1}]')], "bad_config", /no criterion for target .* only for t/],
  ["a budget of 0", ["--budgets-ms", "10,0"], "bad_config", /--budgets-ms\[1\] = 0(\.0)? violates: > 0/],
  ["a negative tolerance", ["--tolerance", "-1"], "bad_config", /--tolerance = -1 violates: >= 0/],
];

for (const [what, flags, word, sentence] of kRefused)
  test(`refused: ${what}`, () => {
    const run = expectExit(2, ...sweepArgs("refused", ...flags));
    assert.match(run.err, sentence);
    assert.ok(run.err.trimEnd().endsWith(`[${word}]`), run.err);
    assert.deepEqual(tracesOf(out("refused")), []);
  });

test("an interrupted sweep leaves nothing, and a folder of another sweep is not overwritten", async () => {
  const { child, finished } = start("sweep", city, ...job, "-o", out("interrupted"), ...some);
  child.stderr.on("data", (words) => words.includes(`] ${budgets[0]} ms\n`) && child.kill("SIGINT"));
  const end = await finished;
  assert.equal(end.code, 3, end.err);
  assert.match(end.err, /\[cancelled\]/);
  assert.deepEqual(tracesOf(out("interrupted")), []);
  assert.match(expectExit(2, ...sweepArgs("first", "--budgets-ms", "20")).err, /\[output_occupied\]/);
});
