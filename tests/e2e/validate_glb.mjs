// Validates a GLB with the Khronos validator: prints its issue counts, fails on any error.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const validator = createRequire(import.meta.url)("gltf-validator");
const report = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])), { maxIssues: 20 });
console.log(JSON.stringify(report.issues, (key, value) => (key === "messages" ? value.slice(0, 5) : value), 2));
process.exit(report.issues.numErrors === 0 ? 0 : 1);
