// A placement that may choose between techniques: no more memory than layers alone, the same promise of time, and each impostor says what
// it promises.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, placed, readJson, resultOf, scratch, smallJob, source } from "./standin.mjs";

const out = join(scratch(), "placed");
const layered = resultOf(placed);

test("depth meshes are placed beside layers where they are smaller", () => {
  expectExit(0, "place", city, ...smallJob, "--budget-ms", String(layered.metrics.budget_ms), "--techniques", "layered,tdm", "-o", out);
  const { placement, metrics } = resultOf(out);
  assert.equal(metrics.cpv.unsolved, 0);
  assert.ok(metrics.memory.texture_bytes <= 1.02 * layered.metrics.memory.texture_bytes, `${metrics.memory.texture_bytes} bytes`);
  for (const impostor of placement.impostors) assert.equal(impostor.guarantee, impostor.technique === "tdm" ? "none" : "nearest");
  assert.ok(placement.impostors.some((impostor) => impostor.technique === "tdm"), "some impostor is a mesh");
  const Ajv = createRequire(import.meta.url)("ajv/dist/2020.js").default;
  const ajv = new Ajv({ strict: true });
  ajv.addSchema(readJson(join(source, "configs/job.schema.json")), "job.schema.json");
  const validate = ajv.compile(readJson(join(source, "configs/placement.schema.json")));
  assert.ok(validate(placement), JSON.stringify(validate.errors?.slice(0, 5)));
});

test("a checker that reads the file alone agrees", () => {
  assert.equal(JSON.parse(expectExit(0, "check", out, "--json").out).violations, 0);
});
