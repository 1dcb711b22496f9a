// `check` believes nothing: whatever is changed in placement.json is found, and named.
import assert from "node:assert/strict";
import { copyFileSync, cpSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { city, expectExit, placed, readJson, scratch, target } from "./standin.mjs";

const folder = scratch();
const original = readJson(join(placed, "placement.json"));
const helped = original.cpvs.findIndex((cpv) => cpv.impostors.length >= 1);

/** `check --json` of the placement after `tamper` changed it, in a folder of its own. */
function checkAfter(name, tamper, code = 1) {
  const copy = join(folder, name.replaceAll(" ", "_"));
  cpSync(placed, copy, { recursive: true });
  const changed = structuredClone(original);
  tamper(changed);
  writeFileSync(join(copy, "placement.json"), JSON.stringify(changed));
  return expectExit(code, "check", copy, "--json");
}

const kTamperings = {
  "a lower bound before": { violation: "bound_before", tamper: (p) => (p.cpvs[helped].bound_before_ms *= 0.99) },
  "a lower bound after": { violation: "bound_after", tamper: (p) => (p.cpvs[helped].bound_after_ms *= 0.99) },
  "a solved region called unsolved": { violation: "not_solved", tamper: (p) => (p.cpvs[helped].solved = false) },
  "no impostors left": { violation: "over_budget", tamper: (p) => (p.cpvs[helped].impostors = []) },
  "a removed CPV": { violation: "missing_region", tamper: (p) => p.cpvs.splice(helped, 1) },
  "another cell's box": { violation: "cell_box", tamper: (p) => (p.cells[p.cpvs[helped].cell].max[0] += 1) },
  "a view cell elsewhere": {
    violation: "not_enclosed",
    tamper: (p) => (p.impostors[p.cpvs[helped].impostors[0]].view_cell = { kind: "box", min: [0, 0, 0], max: [1, 1, 1] }),
  },
  "a view cell that reaches its layers": {
    violation: "layer_in_view_cell",
    tamper: (p) => (p.impostors[0].view_cell = { kind: "box", min: [-500, -500, -500], max: [500, 500, 500] }),
  },
  "impostors that overlap": {
    violation: "not_disjoint",
    tamper: (p) => {
      const first = p.impostors[p.cpvs[helped].impostors[0]];
      p.impostors.push({ ...first, id: p.impostors.length });
      p.cpvs[helped].impostors.push(p.impostors.length - 1);
    },
  },
  "a lower budget": { violation: "missing_region", tamper: (p) => (p.spec.budget_ms *= 0.9) },
};

for (const [name, { violation, tamper }] of Object.entries(kTamperings)) {
  test(name, () => {
    const { findings } = JSON.parse(checkAfter(name, tamper).out);
    const words = new Set(findings.map((finding) => finding.violation));
    assert.ok(words.has(violation), `${violation} is not among ${[...words]}`);
    for (const finding of findings) assert.match(finding.sentence, /^(cpv|cell|impostor) \d+: /);
  });
}

test("the words on stdout name the violation too", () => {
  const { out } = expectExit(1, "check", join(folder, "a_removed_CPV"));
  assert.match(out, /^missing_region: cell \d+: face \S+ interval \d+,\d+ has a bound of .* ms and is no CPV$/m);
});

test("a reference to nothing is a broken file, not a violation", () => {
  const { err } = checkAfter("reference to nothing", (p) => p.cpvs[helped].impostors.push(p.impostors.length), 2);
  assert.match(err, new RegExp(`cpvs\\[${helped}\\]\\.impostors is out of range \\[file_broken\\]`));
});

test("another scene or target file is refused", () => {
  const other = join(folder, "other.glb");
  expectExit(0, "make-city", "--objects", "16", "--triangles", "4000", "-o", other);
  assert.match(expectExit(2, "check", placed, "--scene", other).err, /scene .*other\.glb has SHA-256 .* \[file_broken\]/);
  const otherTarget = join(folder, "other.json");
  writeFileSync(otherTarget, JSON.stringify(readJson(target)));
  assert.match(expectExit(2, "check", placed, "--target", otherTarget).err, /target .*other\.json has SHA-256 .* \[file_broken\]/);
});

test("a moved scene is found by --scene", () => {
  const moved = join(folder, "moved.glb");
  copyFileSync(city, moved);
  expectExit(0, "check", placed, "--scene", moved);
});
