// All rows of the thesis' Table 5.1 in our own figures, and what a placement of ours weighs against each baseline (table_5_1.md holds results).
//
//     node tests/bench/table_5_1.mjs run   BUILD SCENE WORK [ROW..] [-- FLAGS of every run]
//     node tests/bench/table_5_1.mjs print WORK..
//
// BUILD is a build folder (build/release), WORK keeps what was run: a row that is there is not run again. Rows: `budgets` (1 to 5), 6 .. 16,
// `ours`, `rectangular`, `per_cell` (for the ratios at the reference budget) and these and `thesis` with `_sharp` (at the sharp one),
// `ours_as_maps` (ours at the times that environment maps reach, after 15); none: all. The reference budget is the one at which the thesis' fixed
// subdivision has 9,078 problem views; rows 2 to 6 scale it as the thesis scales its 16 ms. The sharp one is that of the same subdivision under
// our own bounds; the thesis' method has them there, too. Table rows are points of `standin sweep`, which writes nothing to check; what ratios are
// taken of is placed, and scored by `standin check`.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const target = join(source, "configs/targets/reference.json");
const config = (name) => ["--config", join(source, "configs/baselines", `${name}.toml`)];
const REFERENCE_CPVS = 9078;
// The thesis' milliseconds, and its figures: CPVs, candidates, impostors, MB.
const THESIS = {
  1: [16, "reference", 9078, 314659, 6650, 14.1], 2: [30, "t_max = 30 ms", 2270, 154696, 1504, 1.01], 3: [25, "t_max = 25 ms", 3562, 204110, 2502, 2.3],
  4: [20, "t_max = 20 ms", 5846, 260891, 4357, 5.7], 5: [15, "t_max = 15 ms", 10172, 327600, 7425, 18.4], 6: [10, "t_max = 10 ms", 18880, 393202, 14270, 103.1],
  7: [16, "256 x 256 pixels", 9078, 426944, 6107, 3.6], 8: [16, "1024 x 1024 pixels", 9078, 214345, 7548, 70.2], 9: [16, "cells of 46 m", 4509, 310598, 7749, 30.6],
  10: [16, "cells of 11.5 m", 24685, 301537, 6306, 11.6], 11: [16, "fewer candidates", 9078, 33864, 6152, 28.6], 12: [16, "more candidates", 9078, 1544822, 7022, 13],
  13: [16, "rectangular view cells", 9078, 812248, 16530, 18.9], 14: [16, "per rectangular cell", 9078, 537776, 137145, 60.4], 15: [null, "environment maps", null, null, 1545, 233.1],
  16: [50, "no visibility", 36629, 1467184, 46845, 80.1],
};
const FLAGS = {
  6: [], 7: ["--width", "256", "--height", "256"], 8: ["--width", "1024", "--height", "1024"], 9: ["--leaf-m", "46"], 10: ["--leaf-m", "11.5"],
  11: ["--apex-deg", "45", "--direction-step-deg", "22.5"], 12: ["--apex-deg", "11.25,16,22.5,32,45,64,90", "--direction-step-deg", "5.625"],
  13: ["--cell-shape", "box"], 14: ["--cell-shape", "cell"], 16: ["--visibility", "off"],
};
const SWEPT_MS = [15, 16, 20, 25, 30];
const SIDES_M = [15, 25, 50], FAR_FIELDS_M = [150, 300, 600, Infinity];  // the last: no maps
// Ratios: what is placed at the two reference budgets; the thesis' method at the first is row 1.
const PLACED = { ours: [], rectangular: config("rectangular"), per_cell: config("per_cell") };
const SHARP = { ...PLACED, thesis: [...config("thesis"), "--region-bounds", "sample"] };
const sharp = (name) => `${name}_sharp`;
// What must hold and what is aimed at: bytes of the baseline over ours.
const RATIOS = { thesis: [5, 15], per_cell: [1.5, 3], rectangular: [1.2, null] };

const read = (file) => JSON.parse(readFileSync(file, "utf8"));
const kept = (work, name) => (existsSync(join(work, `${name}.json`)) ? read(join(work, `${name}.json`)) : null);
const seconds = (stages) => Object.fromEntries(Object.entries(stages).map(([stage, s]) => [stage, Number(s.toFixed(1))]));

function launch(program, ...words) {
  const { status, stdout, stderr } = spawnSync(program, words, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (status !== 0 && status !== 1) throw new Error(`${program} ${words.join(" ")}: ${stderr}`);
  return stdout;
}

class Runs {
  constructor(build, scene, work, flags) {
    Object.assign(this, { scene: resolve(scene), work: resolve(work), flags });
    this.standin = join(resolve(build), "server/standin");
    this.bench = (name) => join(resolve(build), "tests/bench", name);
    mkdirSync(this.work, { recursive: true });
    const share = flags.indexOf("--visibility-missed-share");
    this.missedShare = share < 0 ? "1e-4" : flags[share + 1];
    this.keep("subject", () => ({ scene: scene.split("/").at(-1), flags }));
  }

  /** What `make` returns, made once. */
  keep(name, make) {
    const file = join(this.work, `${name}.json`);
    if (!existsSync(file)) {
      console.error(new Date().toISOString().slice(11, 19), name);
      writeFileSync(file, JSON.stringify(make(), null, 1));
    }
    return read(file);
  }

  /** Budgets on a scale on which the thesis' reference has 16 ms. */
  budget(ms, reference = "reference") {
    const configs = reference === "reference" ? [join(source, "configs/baselines/thesis.toml")] : [];
    const { budget_ms } = this.keep(reference, () => JSON.parse(launch(this.bench("reference_budget"), this.scene, target, `${REFERENCE_CPVS}`, this.missedShare, ...configs)));
    return Number(((budget_ms * ms) / 16).toFixed(6));
  }

  out(name) {
    const folder = join(this.work, name);
    rmSync(folder, { recursive: true, force: true });
    return folder;
  }

  /** Points of a sweep, by ascending budget. */
  sweep(name, budgets, ...more) {
    return this.keep(name, () => {
      const out = this.out(name);
      const start = Date.now();
      launch(this.standin, "sweep", this.scene, "--target", target, "--budgets-ms", budgets.join(","), "--quiet", "--lods", "off", "--survey-views", "1000", "-o", out, ...more, ...this.flags);
      const { points, shared_stages_s } = read(join(out, "sweep.json"));
      return { wall_s: (Date.now() - start) / 1e3, shared_s: seconds(shared_stages_s), points: points.map((point) => ({ ...point, stages_s: seconds(point.stages_s) })) };
    });
  }

  row(row) {
    const of = row.replace(/_sharp$/, "");
    if (row === "budgets") return this.sweep("budgets", SWEPT_MS.map((ms) => this.budget(ms)), ...config("thesis"));
    if (row === "15") return SIDES_M.map((side) => this.maps(side));
    if (row === "ours_as_maps") return this.sweep(row, mapTimes(this.work));
    if (row in PLACED) return this.place(row, this.budget(16), PLACED[row]);
    if (row !== of && of in SHARP) return this.place(row, this.budget(16, "sharp_reference"), SHARP[of]);
    if (!(row in FLAGS)) throw new Error(`no row ${row}`);
    return this.sweep(`row_${row}`, [this.budget(THESIS[row][0])], ...config("thesis"), ...FLAGS[row]);
  }

  /** Placed and checked; the same numbers as a sweep's point. */
  place(name, budget, flags) {
    return this.keep(name, () => {
      const out = this.out(name);
      launch(this.standin, "place", this.scene, "--target", target, "--budget-ms", `${budget}`, "--quiet", "--lods", "off", "--survey-views", "1000", "--verify-views", "0", "-o", out, ...flags, ...this.flags);
      const { budget_ms, cpv, candidates, impostors, memory, stages_s } = read(join(out, "metrics.json"));
      const { violations } = JSON.parse(launch(this.standin, "check", out, "--json"));
      rmSync(out, { recursive: true });
      return { points: [{ budget_ms, cpv, candidates, impostors: impostors.count, texture_bytes: memory.texture_bytes, stages_s: seconds(stages_s), violations }] };
    });
  }

  maps(side) {
    return this.keep(`maps_${side}`, () => launch(this.bench("environment_maps"), this.scene, target, `${side}`, FAR_FIELDS_M.join(","), "96", "64", this.missedShare).trim().split("\n").map((line) => JSON.parse(line)));
  }
}

const allMaps = (work) => SIDES_M.flatMap((side) => kept(work, `maps_${side}`) ?? []);
/** What a placement must promise to be as fast as the maps of one kind, in every region that was looked at. */
const mapTimes = (work) => allMaps(work).filter((maps) => maps.bytes > 0).map((maps) => Number(maps.region_bound_ms.toFixed(3)));

const mb = (bytes) => (bytes / 1e6).toFixed(bytes < 1e5 ? 4 : 2);
const line = (...cells) => console.log(`| ${cells.join(" | ")} |`);
const dash = (value) => value ?? "-";

function point(work, row) {
  const thesisMs = THESIS[row][0];
  if (row > 5) return kept(work, `row_${row}`)?.points[0];
  return kept(work, "budgets")?.points[SWEPT_MS.indexOf(thesisMs)];
}

function stageText(stages) {
  const named = ["view_space", "candidates", "select", "bake", "assemble"].filter((stage) => stages[stage] !== undefined);
  return named.map((stage) => stages[stage].toFixed(0)).join(" + ");
}

function printRow(work, row) {
  const [, what, ...thesis] = THESIS[row];
  if (row === "15") return printMaps(work, what, thesis);
  const found = point(work, row);
  if (!found) return line(row, what, ...thesis.map(dash), "not run", ...Array(6).fill(""));
  const { cpv, candidates, impostors, texture_bytes, stages_s, budget_ms } = found;
  line(row, what, ...thesis.map(dash), budget_ms.toFixed(1), cpv.count, cpv.unsolved, candidates.kept, impostors, mb(texture_bytes), stageText(stages_s));
}

function printMaps(work, what, thesis) {
  const all = allMaps(work);
  const like = all.find((maps) => maps.side_m === 25 && maps.far_field_m === 300);
  if (!like) return line("15", what, ...thesis.map(dash), "not run", ...Array(6).fill(""));
  line("15", `${what} (25 m, 300 m)`, ...thesis.map(dash), "-", "-", "-", "-", `${like.cells} cells`, `${mb(like.bytes)} ± ${mb(like.bytes_standard_error)}`, "");
}

const pointsOf = (work, name) => kept(work, name)?.points ?? [];
const at = (work, name, budget) => pointsOf(work, name).find((one) => Math.abs(one.budget_ms - budget) < 1e-3);

function printRatios(work, which) {
  const reference = kept(work, which);
  if (!reference) return;
  const isSharp = which === "sharp_reference";
  const found = Object.fromEntries(Object.keys(SHARP).map((name) => [name, at(work, isSharp ? sharp(name) : name in PLACED ? name : "budgets", reference.budget_ms)]));
  const whose = isSharp ? "our bounds" : "the thesis' bounds";
  console.log(`\n| placed at ${reference.budget_ms.toFixed(2)} ms (9,078 CPVs in the fixed subdivision under ${whose}) | CPVs | unsolved | candidates | impostors | MB | over ours | must (aim) | check: violations |\n|---|---|---|---|---|---|---|---|---|`);
  for (const [name, one] of Object.entries(found)) {
    const [must, aim] = RATIOS[name] ?? [];
    const wanted = must ? `${must}${aim ? ` (${aim})` : ""}` : "";
    const ratio = one && found.ours && name !== "ours" ? (one.texture_bytes / found.ours.texture_bytes).toFixed(2) : "";
    if (one) line(name, one.cpv.count, one.cpv.unsolved, one.candidates.kept, one.impostors, mb(one.texture_bytes), ratio, wanted, one.violations ?? "a sweep's point");
    else line(name, "not run", ...Array(5).fill(""), wanted, "");
  }
}

/** Ours that promises no more than the maps' time, the loosest there is: at a tighter budget it takes more bytes, so the ratio is a least one. */
function asMaps(maps, points) {
  const promised = points.filter((one) => one.budget_ms <= maps.region_bound_ms + 1e-3).sort((a, b) => b.budget_ms - a.budget_ms)[0];
  if (!promised || !(maps.bytes > 0)) return ["", ""];
  const { budget_ms, texture_bytes, cpv } = promised;
  const exact = Math.abs(budget_ms - maps.region_bound_ms) < 1e-3;
  const ratio = texture_bytes > 0 ? `${exact ? "" : "at least "}${(maps.bytes / texture_bytes).toFixed(1)}` : "no impostor needed";
  return [`${mb(texture_bytes)} at ${budget_ms.toFixed(1)} ms (${cpv.unsolved} of ${cpv.count})`, ratio];
}

function printAllMaps(work) {
  const all = allMaps(work);
  if (all.length === 0) return;
  console.log("\n| cells, m | far field, m | cells (baked) | MB | standard error | walk: mean, worst, bound of the worst, ms | greatest bound of a region, ms | ours with that promise: MB, budget (CPVs unsolved) | maps over ours |\n|---|---|---|---|---|---|---|---|---|");
  const points = ["ours_as_maps", "ours", sharp("ours")].flatMap((name) => pointsOf(work, name));
  for (const maps of all)
    line(maps.side_m, maps.far_field_m ?? "no maps", `${maps.cells} (${maps.sampled})`, mb(maps.bytes), mb(maps.bytes_standard_error), [maps.walk_mean_ms, maps.walk_worst_ms, maps.walk_worst_bound_ms].map((ms) => ms.toFixed(1)).join(", "), maps.region_bound_ms.toFixed(1), ...asMaps(maps, points));
}

function print(work) {
  const { scene, flags } = kept(work, "subject");
  console.log(`\n## ${scene}${flags.length ? `, all runs with \`${flags.join(" ")}\`` : ""}\n`);
  for (const [which, whose] of [["reference", "Reference"], ["sharp_reference", "Sharp reference"]]) {
    const reference = kept(work, which);
    if (reference) console.log(`${whose} budget: ${reference.budget_ms.toFixed(2)} ms; highest bound of a region ${reference.worst_bound_ms.toFixed(2)} ms.\n`);
  }
  line("test", "what", "thesis: CPVs", "candidates", "impostors", "MB", "ours: budget, ms", "CPVs", "of these unsolved", "candidates", "impostors", "MB", "s: view space + candidates + select + bake + assemble");
  console.log(`|${"---|".repeat(13)}`);
  for (const row of Object.keys(THESIS)) printRow(work, row);
  ["reference", "sharp_reference"].forEach((which) => printRatios(work, which));
  printAllMaps(work);
}

const [command, ...words] = process.argv.slice(2);
if (command === "print") {
  words.forEach(print);
} else {
  const split = words.includes("--") ? words.indexOf("--") : words.length;
  const [build, scene, work, ...rows] = words.slice(0, split);
  const runs = new Runs(build, scene, work, words.slice(split + 1));
  for (const row of rows.length ? rows : ["budgets", ...Object.keys(PLACED), ...Object.keys(SHARP).map(sharp), ...Object.keys(FLAGS), "15", "ours_as_maps"]) runs.row(row);
  print(work);
}
