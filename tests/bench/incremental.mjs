// What a second `place` saves with --cache: wall seconds by stage and processor seconds of a job without a cache, of the first with one, and of
// jobs after it: the same again, after an edit of one object, at another budget. Each begins with the folder that the first job left, and its
// bytes are compared with those of a job without a cache. Prints tables.
//
//     node tests/bench/incremental.mjs build/release/server/standin SCENE.glb BUDGET_MS OTHER_BUDGET_MS
//
// Moved by 1 m is the scene's last car. Recoloured is the material that fewest objects show, of those that impostors stand for, and, another
// time, the last building that an impostor stands for, which gets a mesh and a material of its own.
import { spawnSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { readGlb, writeGlb } from "../e2e/glb.mjs";

const binary = resolve(process.argv[2]), scene = resolve(process.argv[3]);
const [budget, otherBudget] = process.argv.slice(4);
const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const target = join(source, "configs/targets/reference.json");
const folder = mkdtempSync(join(tmpdir(), "standin-incremental-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
const path = (name) => join(folder, name);

function place(name, file, budgetMs, ...more) {
  const { status, stderr } = spawnSync("bash", ["-c", 'TIMEFORMAT="%R %U %S"; time "$@"', "bash", binary, "place", file, "--target", target, "--quiet", "--budget-ms", budgetMs, "-o", path(name), ...more], { encoding: "utf8" });
  if (status !== 0 && status !== 1) throw new Error(`${name}: ${stderr}`);
  const [wall, user, system] = stderr.trim().split("\n").at(-1).split(" ").map(Number);
  console.error(`${name}: ${wall} s, ${(user + system).toFixed(1)} s of processor`);
  return { name, wall, cpu: user + system, metrics: JSON.parse(readFileSync(join(path(name), "metrics.json"))) };
}

/** After the first job, from its folder. */
function placeAgain(name, file, budgetMs) {
  cpSync(path("cache"), path(`${name}-cache`), { recursive: true });
  const again = place(name, file, budgetMs, "--cache", path(`${name}-cache`));
  rmSync(path(`${name}-cache`), { recursive: true });
  return again;
}

function edited(name, change) {
  return writeGlb(path(`${name}.glb`), readGlb(scene), change);
}
const lastOf = (json, kind) => json.nodes.filter((node) => node.name.startsWith(kind)).at(-1);
const materialsOf = (json, node) => json.meshes[node.mesh].primitives.map((primitive) => primitive.material);
function rarestMaterial(json, nodes) {
  const uses = (material) => json.nodes.filter((node) => materialsOf(json, node).includes(material)).length;
  return nodes.flatMap((node) => materialsOf(json, node)).sort((a, b) => uses(a) - uses(b))[0];
}
/** Gives a node's first part a material of its own. */
function recolour(json, node) {
  const mesh = structuredClone(json.meshes[node.mesh]);
  const own = structuredClone(json.materials[mesh.primitives[0].material]);
  own.pbrMetallicRoughness = { ...own.pbrMetallicRoughness, baseColorFactor: [0.8, 0.3, 0.3, 1] };
  mesh.primitives[0].material = json.materials.push(own) - 1;
  node.mesh = json.meshes.push(mesh) - 1;
}

const full = place("without a cache", scene, budget);
const first = place("the first with one", scene, budget, "--cache", path("cache"));
const placement = JSON.parse(readFileSync(join(path(full.name), "placement.json")));
const replaced = new Set(placement.impostors.flatMap((impostor) => impostor.objects.map((id) => placement.scene.objects[id].gltf_node)));
const isReplaced = (node) => replaced.has(node.name);
const moved = edited("moved", (json) => (lastOf(json, "car").matrix[12] += 1));
const repainted = edited("repainted", (json) => (json.materials[rarestMaterial(json, json.nodes.filter(isReplaced))].pbrMetallicRoughness.baseColorFactor = [0.8, 0.3, 0.3, 1]));
const recoloured = edited("recoloured", (json) => recolour(json, lastOf({ nodes: json.nodes.filter(isReplaced) }, "building")));

// Each with a job without a cache to compare its bytes and seconds with.
const rows = [{ ...first, plain: full }];
for (const [name, file, budgetMs, plain] of [["the same again", scene, budget, full], ["one object moved", moved, budget], ["a material recoloured", repainted, budget], ["one object recoloured", recoloured, budget], [`${otherBudget} ms`, scene, otherBudget]])
  rows.push({ ...placeAgain(name, file, budgetMs), plain: plain ?? place(`${name}, without`, file, budgetMs) });

const same = (row) => ["placement.json", "impostors.glb"].every((file) => readFileSync(join(path(row.name), file)).equals(readFileSync(join(path(row.plain.name), file))));
const kStages = [["visible_sets", "visible sets"], ["simplified_meshes", "simplified meshes"], ["searches", "searches"], ["bakes", "bakes"]];
const kCached = ["visibility", "lods", "view_space", "size_model", "bake"];
const sum = (metrics, stages) => stages.reduce((total, stage) => total + (metrics.stages_s[stage] ?? 0), 0);

console.log(`| job | ${kStages.map(([, words]) => `${words} made / reused`).join(" | ")} | stages with a cache, s | without, s | ratio | processor, s | without, s | ratio | same bytes |`);
console.log(`|${"---|".repeat(kStages.length + 8)}`);
for (const row of rows) {
  const counts = kStages.map(([stage]) => `${row.metrics.cache[stage].misses} / ${row.metrics.cache[stage].hits}`);
  const mine = sum(row.metrics, kCached), plain = sum(row.plain.metrics, kCached);
  console.log(`| ${[row.name, ...counts, mine.toFixed(1), plain.toFixed(1), (mine / plain).toFixed(2), row.cpu.toFixed(1), row.plain.cpu.toFixed(1), (row.cpu / row.plain.cpu).toFixed(2), same(row) ? "yes" : "NO"].join(" | ")} |`);
}
console.log(`\n| stage, wall s | without a cache | ${rows.map((row) => row.name).join(" | ")} |\n|---|---|${rows.map(() => "---|").join("")}`);
for (const stage of new Set(["load", ...kCached, ...Object.keys(full.metrics.stages_s)]))
  console.log(`| ${stage} | ${[full, ...rows].map((row) => (row.metrics.stages_s[stage] ?? 0).toFixed(2)).join(" | ")} |`);
const { cache } = first.metrics;
console.log(`\nThe first job's folder: ${(cache.folder_bytes / 1e6).toFixed(1)} MB: ${kStages.map(([stage, words]) => `${words} ${(cache[stage].bytes_written / 1e6).toFixed(2)} MB written`).join(", ")}.`);
