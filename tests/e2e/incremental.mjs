// A second job with --cache does again only what an edit reaches, and writes the bytes that a job without writes.
import assert from "node:assert/strict";
import { cpSync, existsSync, readFileSync, readdirSync, truncateSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { readGlb, writeGlb } from "./glb.mjs";
import { expectExit, readJson, resultOf, scratch, source, standin, start, target, tracesOf } from "./standin.mjs";

const folder = scratch();
const path = (name) => join(folder, name);
const city = path("city.glb");
expectExit(0, "make-city", "--objects", "60", "--triangles", "24000", "--seed", "3", "-o", city);

const job = ["--target", target, "--config", join(source, "tests/e2e/small.toml"), "--refine-levels", "1", "--size-bakes", "3", "--verify-views", "0",
             "--survey-views", "100", "--width", "256", "--height", "256"];
const kStages = ["visible_sets", "visibility_audits", "simplified_meshes", "searches", "bakes"];
const kFiles = ["placement.json", "impostors.glb"];
const budgetBetween = (share) => {
  const { reachable_all_ms, worst_bound_ms } = surveyed.survey;
  return (reachable_all_ms + share * (worst_bound_ms - reachable_all_ms)).toFixed(4);
};
const place = (name, scene, budget, ...more) => {
  const run = expectExit(0, "place", scene, ...job, "--quiet", "--budget-ms", budget, "-o", path(name), ...more);
  return { ...run, ...resultOf(path(name)) };
};
const withCache = (name, scene, budget, cache, ...more) => place(name, scene, budget, "--cache", path(cache), ...more);
const counts = ({ metrics }, what) => Object.fromEntries(kStages.map((stage) => [stage, metrics.cache[stage][what]]));
const expectSameBytes = (a, b) => {
  for (const file of kFiles) assert.ok(readFileSync(join(path(a), file)).equals(readFileSync(join(path(b), file))), `${file} of ${a} and ${b} differ`);
};
const entries = (cache, stages = kStages) => stages.flatMap((stage) => (existsSync(join(path(cache), stage)) ? readdirSync(join(path(cache), stage)).map((name) => join(path(cache), stage, name)) : []));
const copied = (name) => (cpSync(path("cache"), path(name), { recursive: true }), name);

/** Metrics without times, memory and what the cache says of itself. */
function timeless(value) {
  if (Array.isArray(value)) return value.map(timeless);
  if (value === null || typeof value !== "object") return value;
  const kept = Object.entries(value).filter(([key]) => !/^(cache|stages_s|shared_stages_s|peak_rss_bytes)$|seconds/.test(key));
  return Object.fromEntries(kept.map(([key, inner]) => [key, timeless(inner)]));
}

expectExit(0, "survey", city, ...job, "--quiet", "-o", path("survey"));
const surveyed = readJson(join(path("survey"), "metrics.json"));
const budget = budgetBetween(0.3);
const full = place("full", city, budget);
const first = withCache("first", city, budget, "cache", "--threads", "1");

/** The scene after an edit. */
function edited(name, change) {
  return writeGlb(path(`${name}.glb`), readGlb(city), change);
}
const materialsOf = (json, node) => json.meshes[node.mesh].primitives.map((primitive) => primitive.material);
const byName = (json, name) => json.nodes.find((node) => node.name === name);
/** Nodes that impostors stand for. */
const replaced = new Set(full.placement.impostors.flatMap((impostor) => impostor.objects.map((id) => full.placement.scene.objects[id].gltf_node)));

test("an empty cache changes nothing, and holds what was made", () => {
  assert.ok(full.metrics.cpv.count > 0 && full.metrics.impostors.count > 0, "there is something to place");
  expectSameBytes("first", "full");
  assert.deepEqual(timeless(first.metrics), timeless(full.metrics));
  assert.equal(full.metrics.cache, undefined);
  for (const stage of kStages) {
    assert.equal(first.metrics.cache[stage].hits, 0, stage);
    assert.ok(first.metrics.cache[stage].misses > 0 && first.metrics.cache[stage].bytes_written > 0, stage);
  }
  assert.equal(first.metrics.cache.folder_bytes, entries("cache").reduce((sum, file) => sum + readFileSync(file).length, 0));
});

test("the same job again makes nothing anew, on more threads", () => {
  const again = withCache("again", city, budget, "cache", "--threads", "3");
  expectSameBytes("again", "full");
  assert.deepEqual(timeless(again.metrics), timeless(full.metrics));
  assert.deepEqual(counts(again, "misses"), { visible_sets: 0, visibility_audits: 0, simplified_meshes: 0, searches: 0, bakes: 0 });
  assert.equal(again.metrics.cache.visible_sets.hits, first.metrics.cache.visible_sets.misses);
  assert.equal(again.metrics.cache.bakes.hits, first.metrics.cache.bakes.misses);
  assert.match(again.out, /^cache: visible sets (\d+) of \1 reused, visibility audits 1 of 1 reused, simplified meshes (\d+) of \2 reused, direction searches (\d+) of \3 reused, bakes (\d+) of \4 reused$/m);
});

test("a job of that cache may go where one without went: it is the same job", () => {
  withCache("full", city, budget, "cache");
  expectSameBytes("full", "first");
});

/** Places an edited scene with and without the first job's cache. */
function afterEdit(name, change, ...more) {
  const scene = edited(name, change);
  const plain = place(`${name}-plain`, scene, budget);
  const cached = withCache(name, scene, budget, copied(`${name}-cache`), ...more);
  expectSameBytes(name, `${name}-plain`);
  assert.deepEqual(timeless(cached.metrics), timeless(plain.metrics));
  for (const stage of ["simplified_meshes", "searches", "bakes"]) assert.ok(cached.metrics.cache[stage].hits > 0, `${stage}: ${JSON.stringify(cached.metrics.cache[stage])}`);
  return cached;
}

test("a material's colour concerns the bakes that show it alone", () => {
  const { json } = readGlb(city);
  const shown = json.nodes.filter((node) => replaced.has(node.name)).flatMap((node) => materialsOf(json, node));
  const uses = (material) => json.nodes.filter((node) => materialsOf(json, node).includes(material)).length;
  const rarest = shown.sort((a, b) => uses(a) - uses(b))[0];
  const cached = afterEdit("recoloured", (scene) => (scene.materials[rarest].pbrMetallicRoughness.baseColorFactor = [0.9, 0.1, 0.1, 1]));
  const { bakes, ...others } = counts(cached, "misses");
  assert.deepEqual(others, { visible_sets: 0, visibility_audits: 0, simplified_meshes: 0, searches: 0 });
  assert.ok(bakes > 0, "some bakes show it");
});

const tree = (scene) => scene.nodes.filter((node) => node.name.startsWith("tree")).at(-1);

test("a tree that moves concerns all visible sets, the cells that see it and the bakes that hold it", () => {
  const cached = afterEdit("moved", (scene) => (tree(scene).matrix[12] += 0.5));
  assert.ok(cached.metrics.cache.visible_sets.misses > 0 && cached.metrics.cache.searches.misses > 0);
  assert.equal(cached.metrics.cache.simplified_meshes.misses, 0, "its mesh is what it was");
});

test("an object that is gone shifts the numbers of others, and no name of a result", () => {
  const gone = byName(readGlb(city).json, "car_0") ? "car_0" : readGlb(city).json.nodes.find((node) => node.name.startsWith("furniture")).name;
  const cached = afterEdit("removed", (scene) => {
    const index = scene.nodes.findIndex((node) => node.name === gone);
    scene.scenes[0].nodes = scene.scenes[0].nodes.filter((node) => node !== index);
  });
  assert.equal(cached.placement.scene.objects.length, full.placement.scene.objects.length - 1);
  assert.ok(cached.metrics.cache.visible_sets.misses > 0);
});

test("--update leaves what the newest job needs, exactly", () => {
  const updated = withCache("updated", path("moved.glb"), budget, copied("update-cache"), "--update");
  expectSameBytes("updated", "moved-plain");
  assert.ok(updated.metrics.cache.removed_entries > 0);
  assert.ok(entries("update-cache").length < entries("moved-cache").length, "without it the folder only grows");
  const again = withCache("updated", path("moved.glb"), budget, "update-cache", "--update");
  assert.deepEqual(counts(again, "misses"), { visible_sets: 0, visibility_audits: 0, simplified_meshes: 0, searches: 0, bakes: 0 });
  assert.equal(again.metrics.cache.removed_entries, 0, "it read every entry");
  assert.equal(again.metrics.cache.folder_bytes, updated.metrics.cache.folder_bytes);
});

test("another budget takes over visible sets, bakes that it shares, and what searches found", () => {
  const tighter = budgetBetween(0.25), looser = budgetBetween(0.6);
  const cache = copied("budgets-cache");
  for (const [name, other] of [["tighter", tighter], ["looser", looser]]) {
    place(`${name}-plain`, city, other);
    const cached = withCache(name, city, other, cache);
    expectSameBytes(name, `${name}-plain`);
    const misses = counts(cached, "misses");
    assert.deepEqual([misses.visible_sets, misses.visibility_audits, misses.simplified_meshes], [0, 0, 0]);
    assert.ok(cached.metrics.cache.bakes.hits > 0, "those of the size models at least");
    assert.ok(cached.metrics.cache.searches.hits > 0);
    if (name === "looser") assert.equal(misses.searches, 0, JSON.stringify(cached.metrics.cache.searches));
  }
});

test("where levels of detail turn out to be in vain, the searches without them are kept, too", () => {
  assert.ok(surveyed.lods.used, "there are levels to be in vain");
  const loose = (3 * surveyed.survey.worst_bound_ms).toFixed(3), cache = copied("vain-cache");
  place("vain-plain", city, loose);
  const first = withCache("vain", city, loose, cache), again = withCache("vain", city, loose, cache);
  expectSameBytes("vain", "vain-plain");
  assert.match(first.metrics.left_out.find(({ stage }) => stage === "lods").reason, /no problem views without them/);
  const { hits, misses } = first.metrics.cache.searches;
  assert.ok(hits > 0 && misses > 0, "with levels all is known, without none");
  assert.deepEqual([again.metrics.cache.searches.hits, again.metrics.cache.searches.misses], [hits + misses, 0]);
});

test("survey and sweep take part, to the same numbers", () => {
  const cache = copied("commands-cache");
  expectExit(0, "survey", city, ...job, "--quiet", "-o", path("cached-survey"), "--cache", path(cache));
  const again = readJson(join(path("cached-survey"), "metrics.json"));
  assert.deepEqual(timeless(again), timeless(surveyed));
  assert.equal(again.cache.visible_sets.misses + again.cache.simplified_meshes.misses + again.cache.searches.misses + again.cache.bakes.misses, 0);
  const sweep = (name, ...more) => {
    const flags = job.filter((flag, i) => flag !== "--verify-views" && job[i - 1] !== "--verify-views");
    expectExit(0, "sweep", city, ...flags, "--quiet", "--budgets-ms", `${budget},${budgetBetween(0.6)}`, "-o", path(name), ...more);
    return readJson(join(path(name), "sweep.json"));
  };
  const plain = sweep("sweep"), cached = sweep("cached-sweep", "--cache", path(cache));
  assert.deepEqual(timeless(cached), timeless(plain));
  assert.ok(cached.cache.bakes.hits > 0 && cached.cache.visible_sets.misses + cached.cache.simplified_meshes.misses === 0);
  const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true, allErrors: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const isSweep = ajv.compile(readJson(join(source, "configs/sweep.schema.json")));
  assert.ok(isSweep(cached), JSON.stringify(isSweep.errors?.slice(0, 5), null, 1));
});

test("damaged entries are made again, and nobody notices", () => {
  const cache = copied("damaged-cache");
  const files = entries(cache);
  for (const [i, file] of files.entries()) {
    const bytes = readFileSync(file);
    if (i % 4 === 0) truncateSync(file, Math.floor(bytes.length / 2));
    if (i % 4 === 1) writeFileSync(file, bytes.map((byte, at) => (at === (i * 7919) % bytes.length ? byte ^ 16 : byte)));
    if (i % 4 === 2) writeFileSync(file, "");
  }
  const cached = withCache("damaged", city, budget, cache);
  expectSameBytes("damaged", "first");
  assert.deepEqual(timeless(cached.metrics), timeless(first.metrics));
  for (const stage of ["visible_sets", "simplified_meshes", "searches", "bakes"]) assert.ok(cached.metrics.cache[stage].misses > 0 && cached.metrics.cache[stage].hits > 0, stage);
  assert.equal(counts(withCache("mended", city, budget, cache), "misses").searches, 0);
});

test("a job that is killed leaves what it had finished, and the next one goes on from there", async () => {
  const { child, finished } = start("place", city, ...job, "--quiet", "--budget-ms", budget, "-o", path("killed"), "--cache", path("killed-cache"));
  while (child.exitCode === null && entries("killed-cache", ["visible_sets", "searches"]).length < 60) await new Promise((done) => setTimeout(done, 5));
  child.kill("SIGKILL");
  assert.equal((await finished).signal, "SIGKILL");
  const cached = withCache("resumed", city, budget, "killed-cache");
  expectSameBytes("resumed", "first");
  assert.ok(cached.metrics.cache.visible_sets.hits > 0);
  assert.ok(cached.metrics.cache.bakes.misses > 0);
});

test("a cache that cannot be, and an update of none, are refused before any work", () => {
  writeFileSync(path("file"), "no folder");
  for (const [flags, word] of [[["--cache", join(path("file"), "cache")], /cannot be written to: Not a directory/], [["--cache", join(path("refused"), "cache")], /outside the result folder/], [["--update"], /--update violates: needs --cache/]]) {
    const { code, err } = standin("place", city, ...job, "--quiet", "--budget-ms", budget, "-o", path("refused"), ...flags);
    assert.equal(code, 2, err);
    assert.match(err, word);
    assert.deepEqual(tracesOf(path("refused")), []);
  }
});
