// configs/*.toml are valid settings, say something other than the defaults, and work.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, readJson, scratch, source, target } from "./standin.mjs";

const folder = scratch();
const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
const validate = new Ajv({ strict: true, allErrors: true }).compile(readJson(join(source, "configs/job.schema.json")));
const preset = (name) => join(source, "configs", name);
const effective = (...args) => JSON.parse(expectExit(0, "place", ...args, "--print-config").out);

test("configs/job.schema.json is what the binary prints, and holds for the defaults", () => {
  assert.deepEqual(readJson(join(source, "configs/job.schema.json")), JSON.parse(expectExit(0, "place", "--print-schema").out));
  assert.ok(validate(effective()), JSON.stringify(validate.errors));
});

for (const name of readdirSync(join(source, "configs")).filter((file) => file.endsWith(".toml"))) {
  test(`${name} is valid and no mere default`, () => {
    const settings = effective("--config", preset(name));
    assert.ok(validate(settings), JSON.stringify(validate.errors));
    assert.notDeepEqual(settings, effective());
    assert.equal(settings.view_space.kind, name.replace(".toml", ""));
  });
}

test("flags win over the file", () => {
  assert.equal(effective("--config", preset("walk.toml"), "--leaf-m", "31").view_space.leaf_m, 31);
});

const survey = (name, scene, ...more) => {
  const out = join(folder, name);
  expectExit(0, "survey", scene, "--target", target, "--config", preset(name), "--size-bakes", "8", "--survey-views", "200", "--quiet",
             "-o", out, ...more);
  return readJson(join(out, "metrics.json"));
};

test("walk.toml surveys the city from its streets", () => {
  const metrics = survey("walk.toml", city, "--visibility-rays", "20000");
  assert.ok(metrics.visibility.occlusion > 0, "streets hide what lies behind the next house");
  assert.ok(metrics.survey.worst_frame_ms > 0 && metrics.survey.worst_frame_ms <= metrics.survey.worst_bound_ms);
});

test("orbit.toml looks at a few objects from all around", () => {
  const few = join(folder, "few.glb");
  expectExit(0, "make-city", "--objects", "16", "--triangles", "20000", "-o", few);
  const metrics = survey("orbit.toml", few, "--refine-levels", "0");
  assert.ok(metrics.left_out.some((entry) => entry.stage === "visibility"), JSON.stringify(metrics.left_out));
  assert.ok(metrics.survey.reachable_all_ms < metrics.survey.worst_bound_ms, "impostors help from afar");
});
