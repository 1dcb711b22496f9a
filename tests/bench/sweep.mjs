// A sweep of 10 budgets against the tightest of them placed alone: wall and processor seconds, their ratios, and what was shared. Runs both in
// turn, ROUNDS times; the least seconds count. Prints tables.
//
//     node tests/bench/sweep.mjs build/release/server/standin SCENE [ROUNDS]
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const binary = resolve(process.argv[2]), scene = resolve(process.argv[3]), rounds = Number(process.argv[4] ?? 1);
const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const target = join(source, "configs/targets/reference.json");
const folder = mkdtempSync(join(tmpdir(), "standin-sweep-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/** Runs a command; wall and processor seconds, and the numbers it wrote. */
function run(command, file, ...flags) {
  const out = join(folder, command);
  rmSync(out, { recursive: true, force: true });
  const { status, stderr } = spawnSync("bash", ["-c", 'TIMEFORMAT="%R %U %S"; time "$@"', "bash", binary, command, scene, "--target", target, "--quiet", "-o", out, ...flags], { encoding: "utf8" });
  if (status !== 0 && status !== 1) throw new Error(`${command}: ${stderr}`);
  const [wall, user, system] = stderr.trim().split("\n").at(-1).split(" ").map(Number);
  return { wall, cpu: user + system, result: JSON.parse(readFileSync(join(out, file))) };
}

const runs = { sweep: [], place: [] };
for (let round = 0; round < rounds; ++round) {
  runs.sweep.push(run("sweep", "sweep.json"));
  const [tightest] = runs.sweep[0].result.points;
  runs.place.push(run("place", "metrics.json", "--budget-ms", String(tightest.budget_ms)));
  console.error(`round ${round + 1}: sweep ${runs.sweep.at(-1).wall} s, place ${runs.place.at(-1).wall} s`);
}
const least = (list, key) => Math.min(...list.map((one) => one[key]));
const sweep = runs.sweep[0].result, place = runs.place[0].result;
const afterwards = ["curves", "gpu_compression", "verify"].reduce((sum, stage) => sum + (place.stages_s[stage] ?? 0), 0);
const planning = (wall) => wall - afterwards;

console.log("| | sweep of 10, s | tightest place, s | ratio |\n|---|---|---|---|");
for (const [what, key] of [["wall", "wall"], ["processor", "cpu"]])
  console.log(`| ${what} | ${least(runs.sweep, key).toFixed(1)} | ${least(runs.place, key).toFixed(1)} | ${(least(runs.sweep, key) / least(runs.place, key)).toFixed(2)} |`);
const [first] = runs.sweep, [alone] = runs.place;
console.log(`| wall, first round, place without curves, compression and verification | ${first.wall.toFixed(1)} | ${planning(alone.wall).toFixed(1)} | ${(first.wall / planning(alone.wall)).toFixed(2)} |`);

console.log(`| peak memory, MB | ${(sweep.peak_rss_bytes / 1e6).toFixed(0)} | ${(place.peak_rss_bytes / 1e6).toFixed(0)} | ${(sweep.peak_rss_bytes / place.peak_rss_bytes).toFixed(2)} |`);

console.log("\n| budget, ms | CPVs | unsolved | impostors | texture, kB | lower bound, kB | bakes | recalled | seconds |\n|---|---|---|---|---|---|---|---|---|");
for (const point of sweep.points)
  console.log(`| ${[point.budget_ms, point.cpv.count, point.cpv.unsolved, point.impostors, (point.texture_bytes / 1e3).toFixed(1), (point.memory_lower_bound_bytes / 1e3).toFixed(1), point.bakes.baked, point.bakes.recalled, point.seconds.toFixed(1)].join(" | ")} |`);

console.log("\n| stage | shared by all budgets, s | all 10 budgets, s | tightest place alone, s |\n|---|---|---|---|");
for (const stage of new Set([...Object.keys(sweep.stages_s), ...Object.keys(place.stages_s)])) {
  const shared = sweep.shared_stages_s[stage] ?? 0, each = (sweep.stages_s[stage] ?? 0) - shared;
  console.log(`| ${stage} | ${shared.toFixed(1)} | ${each.toFixed(1)} | ${(place.stages_s[stage] ?? 0).toFixed(1)} |`);
}
const same = place.memory.texture_bytes === sweep.points[0].texture_bytes;
console.log(`\nTexture bytes of the tightest budget are those of place: ${same ? "yes" : "NO"}.`);
