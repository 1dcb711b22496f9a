// What each stage of `place` costs against the size of the scene: generated cities of equal density (ever more blocks of the same kind), each at
// a budget of its own, since larger ones have slower views. The view space is where one can walk in the whole city. Prints seconds by stage and
// the exponents of the power laws fitted to them (scale.md holds results).
//
//     node tests/bench/scale.mjs build/release/server/standin WORK OBJECTS:BUDGET_MS..
//
// WORK keeps each job's metrics: what is there is not run again. A stage's exponent is the slope of log seconds over log objects, by least
// squares, over the sizes at which it took at least a tenth of a second.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const TRIANGLES_PER_OBJECT = 1967;  // our Vienna's
const LEAST_SECONDS = 0.1;
const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const target = join(source, "configs/targets/reference.json");
const [binary, work] = process.argv.slice(2, 4).map((path) => resolve(path));
const jobs = process.argv.slice(4).map((word) => word.split(":").map(Number));
const sizes = jobs.map(([objects]) => objects);

function standin(...words) {
  const { status, stderr } = spawnSync(binary, words, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (status !== 0 && status !== 1) throw new Error(`standin ${words.join(" ")}: ${stderr}`);
}

/** A city of so many objects, placed; its metrics. Leaves keep their 23 m in cities of any size. */
function placed([objects, budgetMs]) {
  const name = `${objects}_at_${budgetMs}_ms`, kept = join(work, `${name}.json`);
  if (!existsSync(kept)) {
    const scene = join(work, `${name}.glb`), out = join(work, name);
    standin("make-city", "--objects", `${objects}`, "--triangles", `${objects * TRIANGLES_PER_OBJECT}`, "--seed", "1", "-o", scene);
    standin("place", scene, "--target", target, "--budget-ms", `${budgetMs}`, "--max-leaves", "1000000", "--quiet", "-o", out);
    writeFileSync(kept, readFileSync(join(out, "metrics.json")));
    [scene, out].forEach((path) => rmSync(path, { recursive: true }));
  }
  return JSON.parse(readFileSync(kept));
}

function exponent(points) {
  const logs = points.filter(([, seconds]) => seconds >= LEAST_SECONDS).map((point) => point.map(Math.log));
  if (logs.length < 2) return null;
  const mean = (axis) => logs.reduce((sum, point) => sum + point[axis], 0) / logs.length;
  const [x, y] = [mean(0), mean(1)];
  return logs.reduce((sum, point) => sum + (point[0] - x) * (point[1] - y), 0) / logs.reduce((sum, point) => sum + (point[0] - x) ** 2, 0);
}

const line = (...cells) => console.log(`| ${cells.join(" | ")} |`);
const rule = (columns) => console.log(`|${"---|".repeat(columns)}`);

mkdirSync(work, { recursive: true });
const results = jobs.map(placed);

line("objects", "3D leaves", "highest bound, ms", "budget, ms", "problem views", "unsolved", "candidates", "impostors", "texture, kB", "gap at known sizes", "peak memory, GB");
rule(11);
results.forEach(({ visibility, survey, cpv, candidates, impostors, memory, bound, peak_rss_bytes }, i) =>
  line(sizes[i], visibility.cells, survey.worst_bound_ms.toFixed(1), jobs[i][1], cpv.count, cpv.unsolved, candidates.kept, impostors.count, (memory.texture_bytes / 1e3).toFixed(1), bound.selection_gap.toFixed(3), (peak_rss_bytes / 1e9).toFixed(2)));

const stages = [...new Set(results.flatMap(({ stages_s }) => Object.keys(stages_s)))];
const sum = ({ stages_s }) => Object.entries(stages_s).reduce((total, [stage, seconds]) => total + (stage === "verify" ? 0 : seconds), 0);
console.log();
line("stage, s", ...sizes, "exponent");
rule(sizes.length + 2);
for (const [stage, seconds] of [...stages.map((stage) => [stage, ({ stages_s }) => stages_s[stage] ?? 0]), ["all but verify", sum]]) {
  const points = results.map((result, i) => [sizes[i], seconds(result)]);
  line(stage, ...points.map(([, s]) => s.toFixed(1)), exponent(points)?.toFixed(2) ?? "-");
}
