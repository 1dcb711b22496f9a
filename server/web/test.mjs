// Bundles tests/*.test.ts (or tests/NAME.test.ts of the names given) for node and runs them with its test runner.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "standin-web-test-"));
const wanted = process.argv.slice(2).map((name) => `${name}.test.ts`);
const sources = readdirSync(join(here, "tests")).filter(
  (name) => name.endsWith(".test.ts") && (wanted.length === 0 || wanted.includes(name)),
);
try {
  await build({
    entryPoints: sources.map((name) => join(here, "tests", name)),
    outdir: folder,
    bundle: true,
    platform: "node",
    format: "esm",
    outExtension: { ".js": ".mjs" },
    logLevel: "warning",
  });
  const files = readdirSync(folder).map((name) => join(folder, name));
  const env = { STANDIN_GOLDEN_DIR: join(here, "../../tests/golden"), ...process.env };
  process.exitCode = files.length === 0 ? 1 : (spawnSync(process.execPath, ["--test", ...files], { stdio: "inherit", env }).status ?? 1);
} finally {
  rmSync(folder, { recursive: true });
}
