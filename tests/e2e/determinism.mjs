// The same scene, settings and target file give the same bytes, run after run and whatever the thread count.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, placed, readJson, scratch, smallJob } from "./standin.mjs";

const folder = scratch();
const budget = String(readJson(join(placed, "placement.json")).budget_ms);

for (const threads of ["1", "2"]) {
  test(`${threads} thread(s)`, () => {
    const again = join(folder, threads);
    expectExit(0, "place", city, ...smallJob, "--threads", threads, "--budget-ms", budget, "-o", again);
    for (const file of ["placement.json", "impostors.glb"])
      assert.ok(readFileSync(join(again, file)).equals(readFileSync(join(placed, file))), `${file} differs`);
  });
}

test("no path, thread count or time of day is in placement.json", () => {
  const text = readFileSync(join(placed, "placement.json"), "utf8");
  for (const word of [folder, "/", "threads", new Date().getFullYear() + "-"]) assert.ok(!text.includes(word), `it holds "${word}"`);
});
