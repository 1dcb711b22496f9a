// Ctrl-C ends a job within two seconds, whatever it is busy with, and leaves nothing behind.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, scratch, smallJob, start, tracesOf } from "./standin.mjs";

const folder = scratch();
const kLimit_ms = 2000;

/** Runs a command, sends `signal` a moment after stderr names `stage`, and returns how it ended. */
async function interruptIn(stage, signal, args) {
  const { child, finished } = start(...args);
  let sent = 0;
  let seen = "";
  child.stderr.on("data", (text) => {
    seen += text;
    if (sent > 0 || !seen.includes(`] ${stage}\n`)) return;
    sent = performance.now();
    setTimeout(() => child.kill(signal), 100);
  });
  const end = await finished;
  assert.ok(sent > 0, `stage ${stage} was never named: ${end.err}`);
  return { ...end, took_ms: performance.now() - sent };
}

// A job whose named stage takes far longer than the limit.
const place = (out, ...longer) => ["place", city, ...smallJob.filter((flag) => flag !== "--quiet"), "--budget-ms", "40", "-o", out, ...longer];
const kStages = {
  visibility: ["--visibility", "on", "--visibility-rays", "100000000"],
  size_model: ["--size-bakes", "10000", "--texel-scale", "0.1"],
  survey: ["--survey-views", "10000000"],
  verify: ["--verify-views", "20000"],
};

for (const [stage, longer] of Object.entries(kStages)) {
  test(`place, in ${stage}`, async () => {
    const out = join(folder, stage);
    const end = await interruptIn(stage, "SIGINT", place(out, ...longer));
    assert.equal(end.signal, null, "it ends by itself");
    assert.equal(end.code, 3, end.err);
    assert.match(end.err.trimEnd().split("\n").at(-1), /^standin: .*\[cancelled\]$/);
    assert.ok(end.took_ms < kLimit_ms, `it took ${end.took_ms.toFixed(0)} ms`);
    assert.deepEqual(tracesOf(out), []);
  });
}

test("what a killed job leaves behind is swept away by the next one", async () => {
  const out = join(folder, "killed");
  const end = await interruptIn("visibility", "SIGKILL", place(out, ...kStages.visibility));
  assert.equal(end.signal, "SIGKILL");
  assert.equal(tracesOf(out).length, 1, "its staging folder");
  expectExit(0, "survey", city, ...smallJob, "-o", out);
  assert.deepEqual(tracesOf(out), ["killed"]);
});

test("SIGTERM ends it the same way", async () => {
  const out = join(folder, "terminated");
  const end = await interruptIn("visibility", "SIGTERM", place(out, ...kStages.visibility));
  assert.deepEqual([end.signal, end.code], [null, 3]);
  assert.deepEqual(tracesOf(out), []);
});
