// Two neighbouring view spaces in a hall full of machines (thesis 5.8.3): how much the memory of a placement depends on where one may stand
// (power_plant.md holds results).
//
//     apt-get install openfoam-examples      # for this alone: /usr/share/doc/openfoam-examples/examples/resources/geometry/motorBike.obj.gz
//     node tests/bench/power_plant.mjs make  MOTORBIKE.obj.gz OUT.glb
//     node tests/bench/power_plant.mjs place BUILD SCENE.glb WORK TRIANGLES [FLAGS of place]
//
// `make` writes 40 instances of the motor bike, ten times its size, of one material: a mesh of many small triangles instead of the power plant,
// which may not be passed on. `place` bounds the triangles of every view, as the thesis does, from a region of 40 x 40 x 2.5 m amid the
// machines and from its neighbour at their edge: its target file charges a microsecond a triangle, two an impostor's quad, nothing else.
import { spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gunzipSync } from "node:zlib";
import { writeGlb } from "../../server/ktx2/glb.mjs";

const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
const SIZE = 10;  // bikes as large as machines: about 20 m long
const COLUMNS_X = [-120, -100, -80, -60, -40, -20, 0, 20], ROWS_Z = [-70, -52, -34, 34, 52];
// Eyes 1 to 3.5 m above the ground; the first region has machines on all sides but between the rows, the second stands at the last column.
const REGIONS = { amid: [-60, -20], edge: [-20, 20] };
const regionBox = ([x0, x1]) => ({ min: [x0, 1, -20], max: [x1, 3.5, 20] });

/** Positions and triangles of an OBJ file; z up becomes y up, and the model stands on the ground at the origin. */
function readObj(text) {
  const positions = [], indices = [];
  for (const line of text.split("\n")) {
    const [word, ...fields] = line.trim().split(/\s+/);
    if (word === "v") positions.push(Number(fields[0]), Number(fields[2]), -Number(fields[1]));
    if (word !== "f") continue;
    const corners = fields.map((field) => Number.parseInt(field, 10) - 1);
    for (let k = 2; k < corners.length; ++k) indices.push(corners[0], corners[k - 1], corners[k]);
  }
  return { positions: standing(positions), indices };
}

function extent(positions, axis) {
  let least = Infinity, most = -Infinity;
  for (let i = axis; i < positions.length; i += 3) {
    least = Math.min(least, positions[i]);
    most = Math.max(most, positions[i]);
  }
  return [least, most];
}

function standing(positions) {
  const [x, y, z] = [0, 1, 2].map((axis) => extent(positions, axis));
  const offset = [(x[0] + x[1]) / 2, y[0], (z[0] + z[1]) / 2];
  return positions.map((value, i) => value - offset[i % 3]);
}

function make([obj, out]) {
  const { positions, indices } = readObj(gunzipSync(readFileSync(obj)).toString("latin1"));
  const bounds = [0, 1, 2].map((axis) => extent(positions, axis).map(Math.fround));
  const nodes = ROWS_Z.flatMap((z) => COLUMNS_X.map((x) => ({ mesh: 0, name: `machine_${x}_${z}`, translation: [x, 0, z], scale: [SIZE, SIZE, SIZE] })));
  const gltf = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: nodes.map((_, i) => i) }], nodes,
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.6, 0.6, 0.65, 1] }, doubleSided: true }],
    accessors: [{ bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min: bounds.map((b) => b[0]), max: bounds.map((b) => b[1]) },
      { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" }],
    bufferViews: [{ buffer: 0 }, { buffer: 0 }], buffers: [{}],
  };
  const bytes = (array) => Buffer.from(array.buffer);
  writeFileSync(out, writeGlb({ gltf, binary: Buffer.alloc(0) }, new Map([[0, bytes(Float32Array.from(positions))], [1, bytes(Uint32Array.from(indices))]])));
  console.log(`${nodes.length} machines of ${indices.length / 3} triangles each`);
}

/** A target that counts triangles: thousands of them are its milliseconds. */
function triangleTarget(work) {
  const target = JSON.parse(readFileSync(join(source, "configs/targets/reference.json")));
  const units = target.model.milliseconds_per_unit;
  for (const term of Object.keys(units)) units[term] = 0;
  Object.assign(units, { triangles: 1e-3, impostor_quads: 2e-3 });
  Object.assign(target.model, { bound_steps: [{ factor: 1, until_ms: null }] });
  const file = join(work, "triangles.json");
  writeFileSync(file, JSON.stringify({ ...target, id: "triangles, in thousands" }));
  return file;
}

function place([build, scene, work, triangles, ...flags]) {
  mkdirSync(work, { recursive: true });
  const standin = join(resolve(build), "server/standin"), target = triangleTarget(work);
  console.log("| region | budget, triangles | worst sampled view | highest bound | reachable for all | CPVs | unsolved | impostors | MB | check: violations |\n|---|---|---|---|---|---|---|---|---|---|");
  for (const [name, span] of Object.entries(REGIONS)) {
    const { min, max } = regionBox(span);
    const config = join(work, `${name}.toml`), out = join(work, name);
    writeFileSync(config, `[view_space]\nkind = "boxes"\nboxes = [{ min = [${min}], max = [${max}] }]\n[scene]\nsplit_triangles = 4000\n`);
    rmSync(out, { recursive: true, force: true });
    const words = ["place", scene, "--target", target, "--lods", "off", "--config", config, "--budget-ms", `${triangles / 1000}`, "--verify-views", "0", "--survey-views", "2000", "--quiet", "-o", out, ...flags];
    const { status, stderr } = spawnSync(standin, words, { encoding: "utf8", maxBuffer: 1 << 28 });
    if (status !== 0 && status !== 1) throw new Error(`place ${name}: ${stderr}`);
    const { survey, cpv, impostors, memory } = JSON.parse(readFileSync(join(out, "metrics.json")));
    const check = JSON.parse(spawnSync(standin, ["check", out, "--json"], { encoding: "utf8" }).stdout);
    const count = (ms) => (ms === undefined || ms === null ? "-" : Math.round(1000 * ms));
    console.log(`| ${[name, triangles, count(survey.worst_frame_ms), count(survey.worst_bound_ms), count(survey.reachable_all_ms), cpv.count, cpv.unsolved, impostors.count, (memory.texture_bytes / 1e6).toFixed(2), check.violations].join(" | ")} |`);
  }
}

const [command, ...words] = process.argv.slice(2);
({ make, place })[command](words);
