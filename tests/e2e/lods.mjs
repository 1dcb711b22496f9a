// Levels of detail: used where they save enough, shipped, checked; left out, by name, where they do not; a file's own are used as they are.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, readJson, resultOf, scratch, smallJob, source, standin } from "./standin.mjs";

const folder = scratch();
const gltfOf = (file) => {
  const bytes = readFileSync(file);
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
};
const NUMBERS = { 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
/** A GLB's JSON, and the numbers of its accessors. */
const reader = (file) => {
  const bytes = readFileSync(file), gltf = gltfOf(file), first = 20 + bytes.readUInt32LE(12) + 8;
  const numbers = (id, components) => {
    const { bufferView, byteOffset = 0, componentType, count } = gltf.accessors[id], view = gltf.bufferViews[bufferView];
    const at = first + (view.byteOffset || 0) + byteOffset, Numbers = NUMBERS[componentType];
    return new Numbers(bytes.buffer.slice(bytes.byteOffset + at, bytes.byteOffset + at + count * components * Numbers.BYTES_PER_ELEMENT));
  };
  return { gltf, numbers };
};
const survey = (name, ...flags) => {
  expectExit(0, "survey", city, ...smallJob, ...flags, "-o", join(folder, name));
  return readJson(join(folder, name, "metrics.json"));
};
const without = survey("without", "--lods", "off");
const budget = (0.5 * (without.survey.reachable_all_ms + without.survey.worst_bound_ms)).toFixed(3);
const placeAt = (budget, name, ...flags) => {
  const out = join(folder, name);
  expectExit(0, "place", city, ...smallJob, "--budget-ms", budget, "--verify-views", "8", ...flags, "-o", out);
  return { out, ...resultOf(out) };
};
const placed = placeAt(budget, "placed", "--lods", "on");

test("they lower what can be promised, with and without impostors", () => {
  const { survey, lods } = placed.metrics;
  assert.ok(lods.used && lods.objects > 0 && lods.saved_triangles_share > 0, JSON.stringify(lods));
  assert.ok(survey.worst_bound_ms < without.survey.worst_bound_ms, `${survey.worst_bound_ms} against ${without.survey.worst_bound_ms} ms`);
  assert.ok(survey.reachable_all_ms <= without.survey.reachable_all_ms, `${survey.reachable_all_ms} ms`);
});

test("placement.json names them, lods.glb holds them, and the schema and the Khronos validator find no fault", () => {
  const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true, allErrors: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const validate = ajv.compile(readJson(join(source, "configs/placement.schema.json")));
  assert.ok(validate(placed.placement), JSON.stringify(validate.errors?.slice(0, 5), null, 1));
  const file = join(placed.out, "lods.glb");
  const validator = spawnSync(process.execPath, [join(source, "tests/e2e/validate_glb.mjs"), file], { encoding: "utf8" });
  assert.equal(validator.status, 0, validator.stdout + validator.stderr);
  const gltf = gltfOf(file);
  const whole = gltfOf(city);
  const inScene = ({ extras }) => whole.accessors[whole.meshes[extras.scene_mesh].primitives[extras.scene_primitive].indices].count;
  const corners = (primitive) => ("indices" in primitive ? gltf.accessors[primitive.indices].count : inScene(primitive));
  const triangles = (node) => gltf.meshes[node.mesh].primitives.reduce((sum, primitive) => sum + corners(primitive) / 3, 0);
  const nodes = new Map(gltf.nodes.map((node) => [node.name, node]));
  for (const { object, levels } of placed.placement.lods.objects) {
    assert.ok(object < placed.placement.scene.objects.length);
    levels.forEach((level, k) => {
      assert.equal(triangles(nodes.get(level.gltf_node)), level.triangles, level.gltf_node);
      if (k > 0) assert.ok(level.triangles < levels[k - 1].triangles && level.least_distance > levels[k - 1].least_distance);
    });
  }
});

// As a viewer of the two files does it, with none of our code: the scene's vertices, the level's corners, the object's node.
test("put together with the scene's vertices, levels fill the bounds of their objects", () => {
  const scene = reader(city), levelFile = reader(join(placed.out, "lods.glb"));
  const nodesOf = new Map(scene.gltf.nodes.map((node) => [node.name, node]));
  let seen = 0;
  for (const { object, world_from_object, levels } of placed.placement.lods.objects) {
    const { gltf_node, bounds } = placed.placement.scene.objects[object];
    assert.equal(world_from_object, null, "the node says it");
    for (const { gltf_node: name, error } of levels) {
      const min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
      for (const { indices, extras } of levelFile.gltf.meshes[levelFile.gltf.nodes.find((node) => node.name === name).mesh].primitives) {
        const own = scene.gltf.meshes[extras.scene_mesh].primitives[extras.scene_primitive], places = scene.numbers(own.attributes.POSITION, 3);
        for (const corner of indices === undefined ? scene.numbers(own.indices, 1) : levelFile.numbers(indices, 1)) {
          const m = nodesOf.get(gltf_node).matrix, [x, y, z] = places.subarray(3 * corner, 3 * corner + 3);
          for (const a of [0, 1, 2]) {
            const at = m[a] * x + m[4 + a] * y + m[8 + a] * z + m[12 + a];
            [min[a], max[a]] = [Math.min(min[a], at), Math.max(max[a], at)];
          }
        }
      }
      for (const a of [0, 1, 2]) {
        assert.ok(Math.abs(min[a] - bounds.min[a]) <= error + 1e-3, `${name} of object ${object}: ${min} against ${bounds.min}, error ${error}`);
        assert.ok(Math.abs(max[a] - bounds.max[a]) <= error + 1e-3, `${name} of object ${object}: ${max} against ${bounds.max}, error ${error}`);
      }
      ++seen;
    }
  }
  assert.ok(seen > 0);
});

test("lods.glb holds the corners of triangles and nothing else, and they count", () => {
  const { memory, lods } = placed.metrics, gltf = gltfOf(join(placed.out, "lods.glb"));
  assert.equal(memory.lods_bytes, lods.bytes);
  assert.equal(memory.lods_bytes, gltf.buffers[0].byteLength);
  assert.equal(memory.total_bytes, memory.texture_bytes + memory.geometry_bytes + memory.lods_bytes);
  assert.ok(!gltf.materials && !gltf.images, "those of the scene are referred to");
  const corners = gltf.accessors.filter((accessor) => "bufferView" in accessor);
  assert.ok(corners.every((accessor) => accessor.type === "SCALAR"));
  assert.ok(memory.lods_bytes <= corners.reduce((sum, { count, componentType }) => sum + count * (componentType === 5123 ? 2 : 4), 4));
});

test("verify states their image error, which is small", () => {
  const { image } = placed.metrics;
  assert.ok(image.lods_mean_error > 0 && image.lods_mean_error < 0.01, `${image.lods_mean_error}`);
  assert.ok(image.lods_mean_flip > 0 && image.lods_mean_flip < 0.05, `${image.lods_mean_flip}`);
});

const tampered = (name, change, { out, placement: untouched } = placed) => {
  const copy = join(folder, name), file = join(copy, "lods.glb");
  cpSync(out, copy, { recursive: true });
  const placement = structuredClone(untouched), glb = readFileSync(file);
  change(placement.lods, glb);
  placement.lods.asset.sha256 = createHash("sha256").update(glb).digest("hex");
  writeFileSync(join(copy, "placement.json"), JSON.stringify(placement));
  writeFileSync(file, glb);
  return copy;
};
const violations = (copy) => [...new Set(JSON.parse(expectExit(1, "check", copy, "--json").out).findings.map((finding) => finding.violation))];

test("check bounds the errors of the stored levels, and says what that took", () => {
  const checked = JSON.parse(expectExit(0, "check", placed.out, "--json").out);
  assert.ok(checked.levels_s > 0);
  assert.equal(checked.lods_bytes, placed.metrics.memory.lods_bytes);
});

test("a level shown from nearer, and one that lies farther off than stated, are found", () => {
  const nearer = tampered("nearer", (lods) => (lods.objects[0].levels[0].least_distance *= 0.5));
  assert.ok(violations(nearer).includes("levels"));
  const understated = tampered("understated", (lods) => {
    for (const { levels } of lods.objects) for (const level of levels) [level.error, level.least_distance] = [0.3 * level.error, 0.3 * level.least_distance];
  });
  assert.ok(violations(understated).includes("levels"));
  // One corner of a triangle somewhere else on the object, as a slip of ours would have it: the file is sound and says what it is.
  const { bufferViews, accessors } = gltfOf(join(placed.out, "lods.glb"));
  const otherTriangles = tampered("other", (lods, glb) => {
    const first = accessors.find((accessor) => "bufferView" in accessor), wide = first.componentType === 5125;
    const at = 20 + glb.readUInt32LE(12) + 8 + (bufferViews[first.bufferView].byteOffset || 0) + (first.byteOffset || 0);
    const size = wide ? 4 : 2, read = (i) => (wide ? glb.readUInt32LE(at + size * i) : glb.readUInt16LE(at + size * i));
    const far = read(first.count - 1), near = [0, 1, 2].map(read);
    assert.ok(!near.includes(far));
    if (wide) glb.writeUInt32LE(far, at); else glb.writeUInt16LE(far, at);
  });
  assert.deepEqual(violations(otherTriangles), ["levels"]);
});

// No glTF has no node to stand under: vertices are the file's own, and placement.json says where they belong.
test("of a scene that is no glTF, levels under their object's transform fill its bounds", () => {
  const n = 48, lines = [], scene = join(folder, "balls.obj"), out = join(folder, "balls");
  for (const [i, [x, y]] of [[0, 0], [3000, 0], [0, 4000]].entries()) {
    lines.push(`o ball${i}`);
    for (let a = 0; a <= n; ++a)
      for (let b = 0; b < n; ++b) {
        const down = (Math.PI * a) / n, round = (2 * Math.PI * b) / n, r = 100 * (i + 1);
        lines.push(`v ${x + r * Math.sin(down) * Math.cos(round)} ${y + r * Math.sin(down) * Math.sin(round)} ${r * (1.3 - Math.cos(down))}`);
      }
    const at = (a, b) => 1 + i * (n + 1) * n + a * n + (b % n);
    for (let a = 0; a < n; ++a) for (let b = 0; b < n; ++b) lines.push(`f ${at(a, b)} ${at(a, b + 1)} ${at(a + 1, b + 1)} ${at(a + 1, b)}`);
  }
  writeFileSync(scene, lines.join("\n"));
  expectExit(0, "place", scene, ...smallJob, "--up", "z", "--unit", "cm", "--lods", "on", "--lods-error-px", "4", "--budget-ms", "1000", "--verify-views", "0", "-o", out);
  const { placement } = resultOf(out), file = reader(join(out, "lods.glb"));
  assert.ok(placement.lods.objects.length > 0);
  for (const { object, world_from_object: m, levels } of placement.lods.objects) {
    const { bounds } = placement.scene.objects[object];
    for (const { gltf_node, error } of levels)
      for (const { attributes, indices } of file.gltf.meshes[file.gltf.nodes.find((node) => node.name === gltf_node).mesh].primitives) {
        const places = file.numbers(attributes.POSITION, 3), corners = [...file.numbers(indices, 1)];
        for (const a of [0, 1, 2]) {
          const along = corners.map((v) => m[a] * places[3 * v] + m[4 + a] * places[3 * v + 1] + m[8 + a] * places[3 * v + 2] + m[12 + a]);
          assert.ok(Math.abs(Math.min(...along) - bounds.min[a]) <= error + 1e-3, `${gltf_node}: ${Math.min(...along)} against ${bounds.min}`);
          assert.ok(Math.abs(Math.max(...along) - bounds.max[a]) <= error + 1e-3, `${gltf_node}: ${Math.max(...along)} against ${bounds.max}`);
        }
      }
  }
  expectExit(0, "check", out);
  const moved = tampered("moved", (lods) => (lods.objects[0].world_from_object[12] += 1e-6), { out, placement });
  for (const command of ["check", "verify"]) assert.match(expectExit(2, command, moved).err, /world_from_object of object \d+ differs from the scene's/);
  // A vertex that is no number.
  const { accessors, bufferViews, meshes } = file.gltf, { POSITION } = meshes[0].primitives[0].attributes;
  const broken = tampered("no-number", (lods, glb) => {
    const at = 20 + glb.readUInt32LE(12) + 8 + (bufferViews[accessors[POSITION].bufferView].byteOffset || 0) + (accessors[POSITION].byteOffset || 0);
    glb.writeFloatLE(NaN, at);
  }, { out, placement });
  assert.match(expectExit(2, "check", broken).err, new RegExp(`lods\\.glb: accessors\\[${POSITION}\\]: element 0 is no finite number`));
});

test("another lods.glb than the one that was placed is refused", () => {
  const copy = tampered("refused", () => {});
  const glb = readFileSync(join(copy, "lods.glb"));
  glb[glb.length - 8] ^= 1;
  writeFileSync(join(copy, "lods.glb"), glb);
  assert.match(expectExit(2, "check", copy).err, /lods\.glb.*file_broken/);
});

test("verify draws what the file holds", () => {
  const { image } = JSON.parse(standin("verify", placed.out, "--views", "8", "--json").out);
  assert.ok(image.lods_mean_error > 0 && image.lods_mean_error < 0.01, `${image.lods_mean_error}`);
});

test("a budget that needs none ships none, and says so", () => {
  const loose = String(Math.ceil(without.survey.worst_bound_ms + 1));
  const { metrics, placement } = placeAt(loose, "loose", "--lods", "auto");
  assert.deepEqual([metrics.lods.used, metrics.memory.total_bytes, placement.lods], [false, 0, null]);
  assert.match(metrics.left_out.find((entry) => entry.stage === "lods").reason, /no problem views without them/);
});

test("where they would save little they are left out, and named", () => {
  const precise = survey("precise", "--lods", "auto", "--lods-error-px", "0.01");
  assert.equal(precise.lods.used, false);
  assert.ok(precise.left_out.some((entry) => entry.stage === "lods"), JSON.stringify(precise.left_out));
  assert.ok(!without.lods.used && without.left_out.every((entry) => entry.stage !== "lods"), "what is switched off is not left out");
});
