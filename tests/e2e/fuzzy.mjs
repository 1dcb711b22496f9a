// The fuzzy mode, placed and baked: impostors that hold leaves promise nothing and are not judged by the promise; all others keep it.
// And `bake` on its own: what it says of an impostor, and what it refuses.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, placed, readJson, resultOf, scratch, smallJob, source } from "./standin.mjs";

const folder = scratch();
const strict = resultOf(placed);
const names = strict.placement.scene.objects.map((object) => object.name);
const isTree = (id) => names[id].startsWith("tree");

function bake(...args) {
  const out = join(folder, `bake-${bake.count++}`);
  return JSON.parse(expectExit(0, "bake", city, "--json", "--quiet", ...args, "-o", out).out);
}
bake.count = 0;

test("place --fuzzy: guarantee none for what holds trees, nearest for the rest, and the schema agrees", () => {
  const out = join(folder, "placed");
  expectExit(0, "place", city, ...smallJob, "--budget-ms", String(strict.metrics.budget_ms), "--fuzzy", "-o", out);
  const { placement, metrics } = resultOf(out);
  for (const impostor of placement.impostors)
    assert.equal(impostor.guarantee, impostor.objects.some(isTree) ? "none" : "nearest", impostor.objects.map((id) => names[id]).join());
  assert.ok(placement.impostors.some((impostor) => impostor.guarantee === "none"), "some impostor holds a tree");
  assert.equal(placement.spec.impostors.fuzzy, true);
  assert.equal(metrics.image.gap_pixels, 0, "what promises is judged");
  const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const validate = ajv.compile(readJson(join(source, "configs/placement.schema.json")));
  assert.ok(validate(placement), JSON.stringify(validate.errors?.slice(0, 5)));
  assert.equal(JSON.parse(expectExit(0, "check", out, "--json").out).violations, 0);
});

test("bake says what an impostor promises and weighs, on a GPU too", () => {
  const tree = ["--objects", String(names.findIndex((name) => name.startsWith("tree"))), "--view-cell", "shaft:1,0.1,0.3,22.5,40"];
  const whole = bake(...tree), airy = bake(...tree, "--fuzzy");
  assert.deepEqual([whole.guarantee, airy.guarantee], ["nearest", "none"]);
  assert.equal(whole.layers, airy.layers, "the layers do not depend on it");
  const { rgba8, bc1, bc3 } = whole.gpu_bytes;
  assert.ok(rgba8 >= whole.texture_bytes && rgba8 === 8 * bc1 && bc3 === 2 * bc1, "pages hold whole blocks");
  for (const format of ["bc1", "bc3"]) assert.equal(whole.gpu_compression[format].alpha_exact, true);
  assert.equal(bake("--objects", String(names.findIndex((name) => name.startsWith("car"))), "--view-cell", "shaft:1,0,0,22.5,40", "--fuzzy").guarantee, "nearest");
});

test("a cell that is one point needs one layer; one within the cluster is refused with the reason", () => {
  assert.equal(bake("--view-cell", "box:2000,30,0,2000,30,0").layers, 1);
  const { err } = expectExit(2, "bake", city, "--quiet", "--view-cell", "box:-1,1,-1,1,2,1", "-o", join(folder, "never"));
  assert.match(err, /cluster reaches into the view cell.*\[impostor_impossible\]/);
});
