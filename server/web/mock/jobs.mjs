// Jobs of every kind and state: one finished job from a result folder, the others made up from it.
import { readFileSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import {
  bakedFiles,
  explainedFiles,
  needlessFiles,
  olderFiles,
  regressedFiles,
  sweptFiles,
  unacceptedFiles,
  untimedFiles,
  verifiedFiles,
} from "./files.mjs";
import { problem } from "./problem.mjs";

const REFERENCE = join(dirname(fileURLToPath(import.meta.url)), "../../../configs/targets/reference.json");
const EMPTY = {
  label: "",
  aim_met: null,
  best_so_far: null,
  error: null,
  attempts: 1,
  started: null,
  finished: null,
  stage: null,
  fraction: null,
  folder: null,
};

const minutesAgo = (minutes) => new Date(Date.now() - 60_000 * minutes).toISOString();
/// Times of a job that was created so many minutes ago, waited for one and ran for the others.
const times = (created, ran) => ({
  created: minutesAgo(created),
  started: minutesAgo(created - 1),
  finished: ran === undefined ? null : minutesAgo(created - 1 - ran),
});

function requestFor(kind, scene) {
  if (kind === "calibrate") return { kind, arguments: { seconds: 60 } };
  if (kind === "verify") return { kind, job: "done" };
  return { kind, scene: { name: basename(scene) }, target: { name: "reference.json" }, spec: { budget_ms: 30 } };
}

const finished = (result, survey) => [
  { id: "done", kind: "place", label: "the city at night", aim_met: true, ...times(30, 5), folder: result },
  ...(survey ? [{ id: "survey", kind: "survey", ...times(50, 2), folder: survey }] : []),
  { id: "short", kind: "place", label: "budget too low", aim_met: false, ...times(20, 8), folder: result },
  { id: "older", kind: "place", label: "placed last year", aim_met: true, ...times(90, 5), folder: result, files: olderFiles(result) },
  { id: "explained", kind: "place", label: "with causes", aim_met: true, ...times(28, 5), folder: result, files: explainedFiles(result) },
  { id: "needless", kind: "place", label: "fast as it is", aim_met: true, ...times(27, 1), files: needlessFiles(result) },
  { id: "calibrated", kind: "calibrate", aim_met: true, ...times(60, 1), scene: null, files: { "target.json": readFileSync(REFERENCE) } },
  { id: "verified", kind: "verify", aim_met: true, ...times(18, 2), files: verifiedFiles(result, 0) },
  { id: "missed", kind: "verify", label: "three too slow", aim_met: false, ...times(17, 2), files: verifiedFiles(result, 3) },
  {
    id: "few_slow",
    kind: "verify",
    label: "as many too slow as may be",
    aim_met: true,
    ...times(17, 3),
    files: verifiedFiles(result, 8, 100),
  },
  { id: "untimed", kind: "verify", label: "on another machine", aim_met: true, ...times(16, 2), files: untimedFiles(result, 0) },
  { id: "gaps", kind: "verify", label: "with holes", aim_met: false, ...times(16, 3), files: untimedFiles(result, 3) },
  { id: "baked", kind: "bake", aim_met: true, ...times(15, 1), files: bakedFiles(result) },
  { id: "swept", kind: "sweep", aim_met: false, ...times(25, 4), files: sweptFiles() },
  { id: "regressed", kind: "sweep", label: "dearer than before", aim_met: false, ...times(24, 4), files: regressedFiles() },
  { id: "unaccepted", kind: "sweep", label: "dearer than allowed", aim_met: false, ...times(23, 4), files: unacceptedFiles() },
  {
    id: "odd",
    kind: "bake",
    label: "of a later version",
    aim_met: true,
    ...times(14, 1),
    files: { "other.json": Buffer.from('{"a": 1}') },
  },
];

const BROKEN = "accessor 4 reaches 12 bytes beyond its buffer";
const unfinished = [
  {
    id: "failed",
    kind: "place",
    label: "broken scene",
    state: "failed",
    ...times(10, 0),
    error: problem(422, "The scene file is broken", `scene.glb: ${BROKEN}`, {
      word: "file-broken",
      errors: [{ pointer: "/scene", detail: BROKEN }],
    }).body,
  },
  { id: "cancelled", kind: "sweep", state: "cancelled", ...times(9, 1) },
  {
    id: "running",
    kind: "place",
    label: "south quarter",
    state: "running",
    ...times(4),
    stage: "select",
    fraction: 0.4,
    best_so_far: { texture_bytes: 812_345, impostors: 37, unsolved_cpvs: 12 },
  },
  { id: "queued", kind: "survey", state: "queued", created: minutesAgo(1) },
];

/// The oldest first.
export function madeUpJobs({ result, scene, survey }) {
  const jobs = [...finished(result, survey).map((job) => ({ state: "succeeded", ...job })), ...unfinished];
  return jobs
    .map((job) => ({ ...EMPTY, scene, ...job, request: requestFor(job.kind, scene) }))
    .sort((a, b) => a.created.localeCompare(b.created));
}
