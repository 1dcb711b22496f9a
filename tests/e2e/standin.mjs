// What the end-to-end tests share: they run the built binary the way a user does, and look at its exit code, words and files alone.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

export const binary = process.env.STANDIN_BINARY;
export const source = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
/** Files of the fixture (placed_city.mjs), read by the other tests and changed by none. */
export const fixture = resolve(process.env.STANDIN_E2E_WORK, "fixture");

export const city = join(fixture, "city.glb");
export const placed = join(fixture, "placed");
export const target = join(source, "configs/targets/reference.json");
/** Flags of the fixture's jobs. */
export const smallJob = ["--target", target, "--config", join(source, "tests/e2e/small.toml"), "--quiet"];

/** A folder of this test's own, empty, that goes when the process ends. */
export function scratch() {
  mkdirSync(process.env.STANDIN_E2E_WORK, { recursive: true });
  const folder = mkdtempSync(join(resolve(process.env.STANDIN_E2E_WORK), "scratch-"));
  process.on("exit", () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Runs `standin` to its end: {code, out, err}; a run that a signal ended fails here. */
export function standin(...args) {
  const run = spawnSync(binary, args, { encoding: "utf8", maxBuffer: 1 << 28 });
  if (run.error) throw run.error;
  assert.equal(run.signal, null, `standin ${args.join(" ")} was ended by ${run.signal}: ${run.stderr}`);
  return { code: run.status, out: run.stdout, err: run.stderr };
}

/** Runs `standin` and expects an exit code; returns what it printed. */
export function expectExit(code, ...args) {
  const run = standin(...args);
  assert.equal(run.code, code, `standin ${args.join(" ")} exited with ${run.code}\n${run.out}${run.err}`);
  return run;
}

/** Starts `standin` without waiting: {child, finished}; finished resolves to {code, signal, err}. */
export function start(...args) {
  const child = spawn(binary, args, { stdio: ["ignore", "ignore", "pipe"] });
  let err = "";
  child.stderr.setEncoding("utf8").on("data", (text) => (err += text));
  const finished = new Promise((done) => child.on("close", (code, signal) => done({ code, signal, err })));
  return { child, finished };
}

export const readJson = (file) => JSON.parse(readFileSync(file, "utf8"));
export const resultOf = (folder) => ({ placement: readJson(join(folder, "placement.json")), metrics: readJson(join(folder, "metrics.json")) });

/** A value at "a.b.c"; undefined where there is none. */
export const at = (object, path) => path.split(".").reduce((value, key) => value?.[key], object);

/** What a run may leave beside `path`: the path itself, or files staged for it. */
export function tracesOf(path) {
  if (!existsSync(dirname(path))) return [];
  return readdirSync(dirname(path)).filter((name) => name.startsWith(basename(path)));
}
