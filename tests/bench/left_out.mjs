// What a scene does not need, and the seconds that leaving it out saves: six scenes, each placed as it is and with --force all, three times
// each; the least seconds count. Prints a table.
//
//     node tests/bench/left_out.mjs build/release/server/standin [DETAIL]
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { sixScenes } from "../e2e/six_scenes.mjs";

const binary = resolve(process.argv[2]), detail = Number(process.argv[3] ?? 64);
const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const target = join(source, "configs/targets/reference.json");
const kRuns = 3;
const folder = mkdtempSync(join(tmpdir(), "standin-left-out-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

function run(command, job, out, ...flags) {
  const made = join(folder, out);
  rmSync(made, { recursive: true, force: true });
  const { status, stderr } = spawnSync(binary, [command, job.scene, "--target", target, "--config", job.config, "--quiet", ...job.flags, ...flags, "-o", made]);
  if (status !== 0 && status !== 1) throw new Error(`${command} of ${job.name}: ${stderr}`);
  return { made, metrics: JSON.parse(readFileSync(join(made, "metrics.json"))) };
}

/** Least seconds of each stage over the runs. */
function place(job, budget, out, ...flags) {
  const runs = Array.from({ length: kRuns }, () => run("place", job, out, "--budget-ms", budget, ...flags));
  const stages = {};
  for (const { metrics } of runs)
    for (const [stage, seconds] of Object.entries(metrics.stages_s)) stages[stage] = Math.min(stages[stage] ?? Infinity, seconds);
  return { ...runs[0], stages };
}

function row(job) {
  const { reachable_all_ms, worst_bound_ms } = run("survey", job, "survey").metrics.survey;
  const budget = (job.inBudget ? 1.01 * worst_bound_ms : 0.5 * (reachable_all_ms + worst_bound_ms)).toFixed(4);
  const normal = place(job, budget, "normal"), forced = place(job, budget, "forced", "--force", "all");
  const same = ["placement.json", "impostors.glb"].every((file) => readFileSync(join(normal.made, file)).equals(readFileSync(join(forced.made, file))));
  const stages = ["visibility", "size_model", "survey", "candidates", "select", "bake"];
  const total = (stage_s) => stages.reduce((sum, stage) => sum + (stage_s[stage] ?? 0), 0);
  const saved = stages.map((stage) => [stage, (forced.stages[stage] ?? 0) - (normal.stages[stage] ?? 0)]).filter(([, seconds]) => seconds >= 0.01);
  const entry = normal.metrics.left_out.find((left) => left.stage === job.stage && job.says.test(left.reason));
  const where = saved.map(([stage, seconds]) => `${stage} ${seconds.toFixed(2)}`).join(", ") || "none above 0.01";
  return [job.name, `${entry.stage}: ${entry.reason}`, normal.metrics.impostors.count, total(forced.stages).toFixed(2), total(normal.stages).toFixed(2), where, same ? "yes" : "NO"];
}

console.log("| scene | left out | impostors | forced, s | as it is, s | saved by stage, s | same bytes |\n|---|---|---|---|---|---|---|");
for (const job of sixScenes(folder, detail)) console.log(`| ${row(job).join(" | ")} |`);
