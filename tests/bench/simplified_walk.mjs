// Impostors against simplification of the whole scene, at equal frame time (simplified_walk.md holds results).
//
//     npm install --prefix FOLDER gltfpack
//     node tests/bench/simplified_walk.mjs build/release/tests/bench/simplified_walk FOLDER/node_modules/.bin/gltfpack PLACED SCENE TARGET.json WORK [FLAGS of measure]
//     node tests/bench/simplified_walk.mjs table WORK
//
// gltfpack simplifies the scene as placed, in three ways (FAMILIES), each step by step; WORK gets the files and lines.csv.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, openSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { readGlb, writeGlb } from "../../server/ktx2/glb.mjs";

// All without quantisation, so that what differs is the simplification. "limited" never passes a deviation (-se, a share of a mesh's extent,
// 0.01 by default) and so stops short of small ratios; "aggressive" gives up topology and attributes to reach them. These two keep the nodes
// and what visible sets cull, so that the original is their least simplified member. "merged" is gltfpack's own way, which merges meshes of
// one material: fewer draws, less culled.
const KEPT = ["-noq", "-kn", "-km"];
const limited = (ratio, deviation) => [`limited_${ratio}_${deviation}`, ["-si", `${ratio}`, "-se", `${deviation}`, ...KEPT]];
const aggressive = (ratio) => [`aggressive_${ratio}`, ["-si", `${ratio}`, "-sa", ...KEPT]];
const merged = (ratio, ...words) => [`merged_${ratio}`, ["-si", `${ratio}`, ...words, "-noq"]];
const ORIGINAL = ["original"];
const FAMILIES = {
  limited: [ORIGINAL, limited(0.9, 0.01), limited(0.5, 0.01), limited(0.02, 0.01), limited(0.02, 0.05)],
  aggressive: [ORIGINAL, ...[0.9, 0.7, 0.5, 0.25, 0.1, 0.02].map(aggressive)],
  merged: [merged(1), merged(0.5), merged(0.25, "-sa"), merged(0.05, "-sa")],
};
const REPACKED = [["whole", KEPT], ["quantised", ["-kn", "-km"]]];

function run(program, ...words) {
  const { status, stdout, stderr } = spawnSync(program, words, { encoding: "utf8", maxBuffer: 1 << 30 });
  if (status !== 0) throw new Error(`${program} ${words.join(" ")}: ${stderr}`);
  return stdout;
}

/** gltfpack hangs a named node's mesh into nameless children: give them the name. */
function nameMeshNodes(file) {
  const glb = readGlb(readFileSync(file));
  for (const node of glb.gltf.nodes ?? [])
    for (const child of node.children ?? []) glb.gltf.nodes[child].name ??= node.name;
  writeFileSync(file, writeGlb(glb, new Map()));
}

function simplified(gltfpack, original, work, name, flags) {
  const file = join(work, `${name}.glb`);
  run(gltfpack, "-i", original, "-o", file, ...flags);
  nameMeshNodes(file);
  return `${name}=${file}`;
}

function measure([bench, gltfpack, placed, scene, target, work, ...flags]) {
  mkdirSync(work, { recursive: true });
  const original = join(work, "original.glb");
  const textures = flags.flatMap((flag, i) => (flag === "--texture-folder" ? [flag, flags[i + 1]] : []));
  run(bench, "export", placed, scene, original, ...textures);
  const members = [...REPACKED, ...Object.values(FAMILIES).flat().filter((member) => member !== ORIGINAL)];
  const files = members.map(([name, words]) => simplified(gltfpack, original, work, name, words));
  files.forEach((file) => console.error(file, statSync(file.split("=")[1]).size));
  const lines = join(work, "lines.csv");
  const { status } = spawnSync(bench, ["measure", placed, scene, target, ...files, ...flags], { stdio: ["ignore", openSync(lines, "w"), "inherit"] });
  if (status !== 0) throw new Error(`measure ended with ${status}`);
}

/** Rows of lines.csv with numbers as numbers. Where a view has no impostors, both its frames are the original's: one time serves for both. */
function readLines(work) {
  const [head, ...lines] = readFileSync(join(work, "lines.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
  const rows = lines.map((line) => Object.fromEntries(line.map((value, i) => [head[i], ["variant", "kind"].includes(head[i]) ? value : Number(value)])));
  const original_ms = new Map(rows.filter((row) => row.variant === "original").map((row) => [row.view, row.ms]));
  for (const row of rows) if (row.variant === "impostors" && row.impostors === 0) row.ms = original_ms.get(row.view);
  return rows;
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
const at = (values, share) => [...values].sort((a, b) => a - b)[Math.round(share * (values.length - 1))];

/** {variant, triangles, mean_ms, p50_ms, p90_ms, max_ms, mean_error, flip} of the rows, per variant in the order of the file. */
function summaries(rows) {
  return [...new Set(rows.map((row) => row.variant))].map((variant) => {
    const own = rows.filter((row) => row.variant === variant);
    const ms = own.map((row) => row.ms);
    return { variant, triangles: own[0].triangles, mean_ms: mean(ms), p50_ms: at(ms, 0.5), p90_ms: at(ms, 0.9), max_ms: Math.max(...ms),
             mean_error: mean(own.map((row) => row.mean_error)), flip: mean(own.map((row) => row.flip)) };
  });
}

/**
 * The least error of a family at this frame time: of members that take no longer, and on straight lines between neighbours. Null where all
 * take longer.
 */
function errorAt(family, time, key, error) {
  let least = Infinity;
  for (const point of family)
    if (point[key] <= time) least = Math.min(least, point[error]);
  for (let i = 0; i + 1 < family.length; ++i) {
    const [slow, fast] = [family[i], family[i + 1]];
    if (!(slow[key] > time && fast[key] <= time)) continue;
    least = Math.min(least, slow[error] + ((slow[key] - time) / (slow[key] - fast[key])) * (fast[error] - slow[error]));
  }
  return least === Infinity ? null : least;
}

/** Views of which the tables speak: of a kind, or where the original is slow. */
function groupsOf(rows) {
  const originals = rows.filter((row) => row.variant === "original");
  const slow = at(originals.map((row) => row.ms), 0.75);
  const slowViews = new Set(originals.filter((row) => row.ms >= slow).map((row) => row.view));
  return { walk: rows.filter((row) => row.kind === "walk"), "regions over budget": rows.filter((row) => row.kind === "region"),
           "slowest quarter": rows.filter((row) => slowViews.has(row.view)), all: rows };
}

const ms = (value) => value.toFixed(2);
const small = (value) => (value === null ? "not reached" : value.toFixed(5));

function printGroup(name, rows, work) {
  const table = summaries(rows), time = (row) => [row.mean_ms, row.p50_ms, row.p90_ms, row.max_ms].map(ms).join(", ");
  const drawn = rows.filter((row) => row.variant === "impostors" && row.impostors > 0).length;
  console.log(`\n### ${name}: ${rows.filter((row) => row.variant === "original").length} views, ${drawn} with impostors\n`);
  console.log("| drawn | triangles | mean, p50, p90, max ms | mean error | FLIP | file |\n|---|---|---|---|---|---|");
  for (const row of table) {
    const file = join(work, `${row.variant}.glb`);
    const size = existsSync(file) ? `${(statSync(file).size / 1e6).toFixed(2)} MB` : "";
    console.log(`| ${row.variant} | ${row.triangles} | ${time(row)} | ${small(row.mean_error)} | ${small(row.flip)} | ${size} |`);
  }
  const heads = Object.keys(FAMILIES).map((family) => `${family}: error, FLIP`).join(" | ");
  console.log(`\n| at the impostors' | ms | impostors: error, FLIP | ${heads} |\n|---|---|---|---|---|---|`);
  const impostors = table.find((row) => row.variant === "impostors");
  for (const key of ["mean_ms", "max_ms"]) {
    const families = Object.values(FAMILIES).map((family) => {
      const points = family.map(([variant]) => table.find((row) => row.variant === variant));
      return ["mean_error", "flip"].map((error) => small(errorAt(points, impostors[key], key, error))).join(", ");
    });
    console.log(`| ${key.slice(0, -3)} | ${ms(impostors[key])} | ${small(impostors.mean_error)}, ${small(impostors.flip)} | ${families.join(" | ")} |`);
  }
}

const words = process.argv.slice(2);
if (words[0] !== "table") measure(words);
const work = words[0] === "table" ? words[1] : words[5];
for (const [name, rows] of Object.entries(groupsOf(readLines(work)))) if (rows.length > 0) printGroup(name, rows, work);
