// Bad input: refused by one line on stderr with the promised word, with the promised exit code, and nothing is written.
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { triangles, writeGlb } from "./glb.mjs";
import { city, placed, readJson, scratch, standin, target, tracesOf } from "./standin.mjs";

const folder = scratch();
const inputs = join(folder, "inputs");
const out = join(folder, "out");
mkdirSync(inputs);

const triangle = triangles([0, 0, 0, 1, 0, 0, 0, 1, 0]);
const glb = (name, scene, change) => writeGlb(join(inputs, name), scene, change);
const text = (name, content) => (writeFileSync(join(inputs, name), content), join(inputs, name));
const changedTarget = (name, change) => {
  const changed = readJson(target);
  change(changed);
  return text(name, JSON.stringify(changed));
};
const externalBuffer = (uri) => (json) => (json.buffers[0].uri = uri);

const truncated = join(inputs, "truncated.glb");
writeFileSync(truncated, readFileSync(city).subarray(0, 20000));
const occupied = join(folder, "occupied");
mkdirSync(occupied);
writeFileSync(join(occupied, "thesis.txt"), "mine");

const noTile = join(folder, "tiles");
mkdirSync(noTile);
writeFileSync(join(noTile, "12-1-2.mvt"), "<html>404</html>");
const realCity = (osm) => ["make-city", "--osm", osm, "--furniture", inputs, "-o", join(out, "city.glb")];

const place = (scene, ...more) => ["place", scene, "--target", target, "--budget-ms", "20", "-o", out, ...more];
const placeFor = (targetFile) => ["place", city, "--target", targetFile, "--budget-ms", "20", "-o", out];
const placeIn = (budget) => ["place", city, "--target", target, "--budget-ms", budget, "-o", out];

// What, arguments, exit code, error word, what the sentence must name.
const kRows = [
  ["a scene that is not there", place("nowhere.glb"), 2, "file_missing", /nowhere\.glb/],
  ["a truncated GLB", place(truncated), 2, "file_broken", /truncated\.glb/],
  ["a scene that is no scene", place(text("prose.glb", "once upon a time")), 2, "file_broken", /prose\.glb/],
  ["a buffer above the scene's folder", place(glb("up.glb", triangle, externalBuffer("../secret.bin"))), 2, "uri_forbidden", /\.\.\/secret\.bin/],
  ["an absolute buffer", place(glb("root.glb", triangle, externalBuffer("/etc/passwd"))), 2, "uri_forbidden", /\/etc\/passwd/],
  ["a buffer on the network", place(glb("net.glb", triangle, externalBuffer("https://example.com/a.bin"))), 2, "uri_forbidden", /example\.com/],
  ["a required extension nobody knows", place(glb("ext.glb", triangle, (j) => (j.extensionsRequired = j.extensionsUsed = ["ACME_magic"]))), 2,
   "extension_unknown", /ACME_magic/],
  ["nothing but NaN positions", place(glb("nan.glb", triangles(Array(9).fill(NaN)))), 2, "scene_empty", /nan\.glb/],
  ["no triangles at all", place(glb("bare.glb", triangle, (j) => delete j.nodes[0].mesh)), 2, "scene_empty", /bare\.glb/],
  ["triangles without area", place(glb("flat.glb", triangles(Array(9).fill(1)))), 2, "scene_empty", /flat\.glb/],
  ["a walk with nowhere to stand", place(glb("wall.glb", triangle), "--view-space", "walk"), 2, "view_space_empty", /no position/],
  ["view space boxes that are not given", place(city, "--view-space", "boxes"), 2, "view_space_empty", /view_space\.boxes/],
  ["a path file that is not there", place(city, "--view-space", "path:nowhere.csv"), 2, "file_missing", /nowhere\.csv/],
  ["a path file that is none", place(city, "--view-space", "path:" + text("path.csv", "1,2\n")), 2, "file_broken", /path\.csv:1/],
  ["no budget", ["place", city, "--target", target, "-o", out], 2, "bad_usage", /--budget-ms/],
  ["a budget of 0", placeIn("0"), 2, "bad_usage", /--budget-ms 0.* > 0/],
  ["a negative budget", placeIn("-1"), 2, "bad_config", /--budget-ms.*-1.*>=? 0/],
  ["a budget that is no number", placeIn("abc"), 2, "bad_config", /--budget-ms.*abc.*number/],
  ["a budget that is not finite", placeIn("1e999"), 2, "bad_config", /--budget-ms/],
  ["a leaf of no size", place(city, "--leaf-m", "0"), 2, "bad_config", /--leaf-m = 0 violates: > 0/],
  ["a fractional seed", place(city, "--seed", "1.5"), 2, "bad_config", /--seed = 1\.5/],
  ["more threads than any machine has", place(city, "--threads", "100000"), 2, "bad_config", /--threads = 100000 violates: <= 1024/],
  ["a target that is not there", placeFor("nowhere.json"), 2, "file_missing", /nowhere\.json/],
  ["a target that is no JSON", placeFor(text("prose.json", "once")), 2, "file_broken", /prose\.json/],
  ["a target of an old format", placeFor(changedTarget("old.json", (t) => (t.version = 0))), 2, "target_unreadable", /old\.json.*version 0.*version 2/],
  ["a target with a negative cost", placeFor(changedTarget("negative.json", (t) => (t.model.milliseconds_per_unit.triangles = -1))), 2,
   "file_broken", /negative\.json.*"triangles" is -1/],
  ["a target that lacks a cost", placeFor(changedTarget("lacks.json", (t) => delete t.model.milliseconds_per_unit.draws)), 2, "file_broken",
   /lacks\.json.*"draws"/],
  ["a configuration that is not there", place(city, "--config", "nowhere.toml"), 2, "file_missing", /nowhere\.toml/],
  ["an unknown setting", place(city, "--config", text("unknown.toml", "[view_space]\nleafs_m = 3\n")), 2, "bad_config", /unknown\.toml.*view_space\.leafs_m/],
  ["a configuration that is no TOML", place(city, "--config", text("broken.toml", "seed = = 3\n")), 2, "bad_config", /broken\.toml:1:/],
  ["an unknown flag", place(city, "--magic"), 2, "bad_usage", /--magic/],
  ["another command's flag", ["info", city, "--budget-ms", "20"], 2, "bad_usage", /--budget-ms/],
  ["an unknown command", ["enchant", city], 2, "bad_usage", /enchant/],
  ["no command", [], 2, "bad_usage", /subcommand/],
  ["a missing output folder", ["place", city, "--target", target, "--budget-ms", "20"], 2, "bad_usage", /--output/],
  ["an output folder with other files", ["place", city, "--target", target, "--budget-ms", "20", "-o", occupied], 2, "output_occupied", /occupied/],
  ["an output folder that is a file", ["place", city, "--target", target, "--budget-ms", "20", "-o", city], 2, "output_occupied", /city\.glb/],
  ["another job's result folder", ["place", city, "--target", target, "--budget-ms", "1000", "-o", placed], 2, "output_occupied", /placed/],
  ["a check of no result", ["check", inputs], 2, "file_missing", /placement\.json/],
  ["bad view cells", ["bake", city, "--view-cell", "sphere:1,2,3", "-o", out], 2, "bad_usage", /sphere:1,2,3/],
  ["a technique that nobody knows", ["bake", city, "--technique", "magic", "--view-cell", "shaft:1,0,0,45,60", "-o", out], 2, "bad_usage", /magic/],
  ["a technique that nobody knows among those of a placement", place(city, "--techniques", "layered,magic"), 2, "bad_config",
   /--techniques = "layered,magic" violates: one or more of layered, tdm, planar, lod-sprite/],
  ["no technique", place(city, "--techniques", ""), 2, "bad_config", /--techniques.*one or more of layered, tdm, planar, lod-sprite/],
  ["a technique left out between commas", place(city, "--techniques", "layered,,tdm"), 2, "bad_config", /--techniques.*one or more of/],
  ["objects that are not there", ["bake", city, "--objects", "7,150", "--view-cell", "shaft:1,0,0,45,60", "-o", out], 2, "bad_usage", /150/],
  ["a city too small to be one", ["make-city", "--objects", "3", "-o", join(out, "city.glb")], 2, "bad_usage", /3/],
  ["a map without furniture", ["make-city", "--osm", inputs, "-o", join(out, "city.glb")], 2, "bad_usage", /--furniture/],
  ["furniture without a map", ["make-city", "--furniture", inputs, "-o", join(out, "city.glb")], 2, "bad_usage", /--osm/],
  ["a map that is not there", realCity(join(folder, "absent")), 2, "file_missing", /absent/],
  ["a folder without tiles", realCity(inputs), 2, "file_missing", /no tile/],
  ["a tile that is none", realCity(noTile), 2, "file_broken", /12-1-2\.mvt is not a vector tile/],
  ["a city in a folder that is not there", ["make-city", "--objects", "16", "--triangles", "4000", "-o", join(out, "no/city.glb")], 2, null, /city\.glb/],
];

const before = { folder: readdirSync(folder), occupied: readdirSync(occupied), placed: readdirSync(placed) };

for (const [what, args, code, word, sentence] of kRows) {
  test(what, () => {
    const run = standin(...args, ...(args.length > 0 && args[0] !== "enchant" ? ["--quiet"] : []));
    assert.equal(run.code, code, `exit code ${run.code}; ${run.err}`);
    assert.equal(run.out, "", "nothing on stdout");
    const [line, ...rest] = run.err.trimEnd().split("\n");
    assert.deepEqual(rest, [], "one line");
    if (word !== null) assert.ok(line.endsWith(`[${word}]`), line);
    assert.match(line, /^standin: .* \[[a-z_]+\]$/);
    assert.match(line, sentence);
    assert.deepEqual(tracesOf(out), []);
    assert.deepEqual({ folder: readdirSync(folder), occupied: readdirSync(occupied), placed: readdirSync(placed) }, before);
  });
}
