// `verify` on a machine that is not the target's: images are judged, times are left out by name.
import assert from "node:assert/strict";
import { cpSync, readdirSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { expectExit, placed, readJson, scratch } from "./standin.mjs";

const copy = join(scratch(), "placed");
cpSync(placed, copy, { recursive: true });

test("times are null and named as left out, all else is judged", () => {
  const before = readdirSync(copy).sort();
  expectExit(0, "verify", copy, "--views", "12", "--judged-views", "7", "--seed", "5", "--quiet");
  const { verify, image } = readJson(join(copy, "verify.json"));
  assert.equal(verify.views, 12);
  assert.equal(verify.over_budget_measured, null);
  assert.equal(verify.measured_coverage, null);
  const { worst_views } = readJson(join(copy, "metrics.json")).survey;
  const surveyed = verify.frames.filter((frame) => frame.origin === "surveyed");
  assert.deepEqual(surveyed.map((frame) => frame.position), worst_views.slice(0, 3).map((view) => view.position), "a quarter at most");
  for (const times of [verify.frame_ms_before, verify.frame_ms_after]) assert.deepEqual(times, { p50: null, p99: null, max: null });
  assert.ok(verify.left_out.some((reason) => /frame times.*(device|renderer)/.test(reason)), JSON.stringify(verify.left_out));
  assert.equal(verify.over_budget_estimated, 0);
  assert.equal(image.gap_pixels, 0);
  assert.ok(image.max_parallax_ratio <= 1);
  assert.equal(image.views, 7);
  assert.deepEqual(readdirSync(copy).sort(), [...before, "verify.json"].sort(), "it touches nothing else");
});

test("report writes the page again from the folder alone", () => {
  expectExit(0, "report", copy);
});
