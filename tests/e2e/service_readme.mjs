// What README.md says of the service: its curl commands run as they stand, and its table of limits is what `serve --help` says.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { cpSync, existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import test, { after } from "node:test";
import { binary, city, expectExit, readJson, scratch, source } from "./standin.mjs";

const readme = readFileSync(join(source, "README.md"), "utf8");
const folder = scratch();
let child;
after(() => child?.kill("SIGKILL"));

test("the curl commands of README.md", async () => {
  cpSync(city, join(folder, "city.glb"));
  child = spawn(binary, ["serve", "--data", "jobs", "--listen", "127.0.0.1:0", "--targets", join(source, "configs/targets")], { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((done) => child.stdout.once("data", (text) => done(String(text).trim())));
  const [, script] = readme.match(/service_readme\.mjs runs this -->\n```sh\n([^`]*)```/);
  // Coarser than the defaults, so that it takes seconds.
  const quick = '"spec": {"budget_ms": 60, "view_space": {"leaf_m": 46, "refine_levels": 0}, "verify": {"views": 0}, "survey": {"views": 200}}';
  const run = spawnSync("bash", ["-euo", "pipefail", "-c", script.replace("http://127.0.0.1:8080", url).replace('"spec": {"budget_ms": 60}', quick)], { cwd: folder, encoding: "utf8" });
  assert.equal(run.status, 0, run.stderr + run.stdout);
  assert.match(run.stdout, /"state": "succeeded"/);
  assert.match(run.stdout, /event: progress/);
  assert.equal(readJson(join(folder, "placement.json")).format, "standin.placement");
  child.kill();
});

test("the table of limits is what the program says", () => {
  const help = expectExit(0, "serve", "--help").out.replace(/\n {10,}/g, " ");
  const rows = [...readme.matchAll(/^\| `(--[a-z-]+)` \| (\d+) \| (.*) \|$/gm)];
  assert.ok(rows.length >= 12);
  for (const [, flag, value, text] of rows)
    assert.match(help, new RegExp(`${flag} .*=${value}\\s+${text.split(";")[0]}`), flag);
});

test("the unit starts what there is", () => {
  const unit = readFileSync(join(source, "configs/standin.service"), "utf8");
  const help = expectExit(0, "serve", "--help").out;
  for (const [flag] of unit.match(/^ExecStart=.*$/m)[0].matchAll(/--[a-z-]+/g)) assert.ok(help.includes(flag), flag);
  assert.ok(existsSync(binary));
});
