// A fit can be repeated from its samples, anywhere, byte for byte (calibrate --refit).
import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { expectExit, readJson, scratch } from "./standin.mjs";

const folder = scratch();
const kTerms = ["frame", "draws", "texture_switches", "triangles", "on_screen_triangles", "edge_pixels", "plain_pixels", "textured_pixels",
                "masked_pixels", "impostor_quads", "impostor_pixels"];
// About what an empty frame, a draw and a triangle cost; nothing else costs anything.
const kCosts = { frame: 0.3, draws: 0.004, triangles: 3e-5 };

// A linear congruential generator: the same rows on every machine.
let state = 12345;
const random = () => (state = (state * 1103515245 + 12345) % 2147483648) / 2147483648;

function samples(rows) {
  const lines = ["# standin.samples 2", "# device: osmesa", "# renderer: some renderer", "# gl_version: 4.5", "# processor: some processor",
                 "# reference_ms: 2.5", "# clock: thread_cpu", ["group", "designed", "milliseconds", "spread", "seconds", "passed_pixels", ...kTerms].join()];
  for (let i = 0; i < rows; ++i) {
    const size = 10 ** (-2 * random());
    const value = { frame: 1, draws: Math.floor(4000 * size * random()), triangles: Math.floor(1e6 * size * random()) };
    const ms = Object.entries(kCosts).reduce((sum, [term, cost]) => sum + cost * value[term], 0) * (1 + 0.02 * (random() - 0.5));
    lines.push([i % 3, 0, ms, 0.01, 0.1 * (i + 1), 0, ...kTerms.map((term) => value[term] ?? 0)].join());
  }
  return lines.join("\n") + "\n";
}

const csv = join(folder, "samples.csv");
writeFileSync(csv, samples(300));

test("the fit finds the costs that made the samples, and names the machine", () => {
  expectExit(0, "calibrate", "--refit", csv, "-o", join(folder, "target.json"));
  const { machine, model, quality } = readJson(join(folder, "target.json"));
  for (const [term, cost] of Object.entries(kCosts))
    assert.ok(Math.abs(model.milliseconds_per_unit[term] / cost - 1) < 0.05, `${term}: ${model.milliseconds_per_unit[term]}`);
  assert.deepEqual([machine.renderer, machine.processor, machine.reference_ms], ["some renderer", "some processor", 2.5]);
  assert.equal(quality.samples, 300);
});

test("again: the same bytes", () => {
  expectExit(0, "calibrate", "--refit", csv, "-o", join(folder, "again.json"));
  assert.ok(readFileSync(join(folder, "target.json")).equals(readFileSync(join(folder, "again.json"))));
});

test("an error within reach is exit 0, one out of reach exit 1, and the target is written all the same", () => {
  const args = ["calibrate", "--refit", csv, "--json", "-o", join(folder, "aimed.json"), "--target-error"];
  const reached = JSON.parse(expectExit(0, ...args, "0.05").out);
  assert.ok(reached.median_error <= 0.05 && reached.held_out_frames === 300 && reached.misses <= 6, JSON.stringify(reached));
  expectExit(1, ...args, "1e-6");
  assert.equal(readJson(join(folder, "aimed.json")).quality.samples, 300);
});

test("the learning curve and the coverage asked for are in the target", () => {
  expectExit(0, "calibrate", "--refit", csv, "--coverage", "0.9", "-o", join(folder, "loose.json"));
  const { model, quality } = readJson(join(folder, "loose.json"));
  assert.equal(model.coverage, 0.9);
  assert.deepEqual(quality.learning_curve.map((point) => [point.seconds, point.frames]), [[5, 50], [10, 100], [20, 200], [30, 300]]);
});

test("the explanation is in words", () => {
  const { out } = expectExit(0, "calibrate", "--refit", csv, "--explain", "-o", join(folder, "words.json"));
  assert.match(out, /an empty frame costs 300 us\n/);
  assert.match(out, /a draw call costs 4\.0 us\n/);
});

test("what would be ignored is refused", () => {
  const target = join(folder, "target.json");
  for (const words of [["--refit", csv, "scene.glb", "-o", target], ["--evaluate", target, "-o", join(folder, "x.json")], ["--evaluate", target, "--explain"],
                       ["--evaluate", target, "--coverage", "0.9"], ["--evaluate", target, "--target-error", "0.1"], ["--refit", csv, "--samples", csv, "-o", target]])
    assert.match(expectExit(2, "calibrate", ...words).err, /\[bad_usage\]/, words.join(" "));
});

test("a broken row is named with its line, and nothing is written", () => {
  const broken = join(folder, "broken.csv");
  writeFileSync(broken, samples(20).replace("\n1,", "\n1,fast"));
  const before = readdirSync(folder).sort();
  assert.match(expectExit(2, "calibrate", "--refit", broken, "-o", join(folder, "no.json")).err, /broken\.csv, line 10: "fast.*\[file_broken\]/);
  assert.match(expectExit(2, "calibrate", "--refit", csv).err, /-o FILE.*\[bad_usage\]/);
  assert.deepEqual(readdirSync(folder).sort(), before);
});
