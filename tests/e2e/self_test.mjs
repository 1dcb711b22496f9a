// calibrate --self-test: every stated case of the fit holds, on this machine too, without a device and without writing anything.
import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import test from "node:test";
import { expectExit, scratch } from "./standin.mjs";

test("every case passes and says what it got", () => {
  const folder = scratch();
  const before = readdirSync(folder).sort();
  const { cases, passed, failed } = JSON.parse(expectExit(0, "calibrate", "--self-test", "--json").out);
  assert.ok(cases.length >= 25);
  assert.deepEqual([passed, failed], [cases.length, 0]);
  for (const entry of cases) assert.ok(entry.passed && entry.name && entry.expected && entry.got, JSON.stringify(entry));
  const table = expectExit(0, "calibrate", "--self-test").out;
  for (const entry of cases) assert.ok(table.includes(`| ${entry.name} | ${entry.expected} | ${entry.got} | ok |`), entry.name);
  assert.deepEqual(readdirSync(folder).sort(), before);
});

test("it takes no other task beside it", () => {
  for (const flag of ["--refit", "--evaluate", "--samples", "-o"]) expectExit(2, "calibrate", "--self-test", flag, "some.file");
});
