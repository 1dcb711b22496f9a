// A job's state in words.

import { element } from "./elements";
import type { Job, JobKind } from "./api";
import { duration } from "./text";

export const KIND_TEXT: Record<JobKind, string> = {
  place: "place: impostors with which every view meets the budget",
  survey: "survey: where frames are slow, why, and how low the budget can go",
  sweep: "sweep: memory against the budget",
  calibrate: "calibrate: time the server's machine, to get a target file",
  verify: "verify: render and measure a finished placement",
  bake: "bake: one impostor, with its image metrics",
};

const KIND_NOUN: Record<JobKind, string> = {
  place: "Placement",
  survey: "Survey",
  sweep: "Sweep",
  calibrate: "Calibration",
  verify: "Verification",
  bake: "Bake",
};

/// "Survey of city.glb".
export const whatItIs = ({ kind, scene }: Job) => [KIND_NOUN[kind], scene?.name].filter(Boolean).join(" of ");
/// What a job is called: by its label, or by what it does to which scene.
export const jobTitle = (job: Job) => job.label || whatItIs(job);

const STAGE_TEXT: Record<string, string> = {
  load: "loading the scene",
  visibility: "finding what each cell may see",
  view_space: "dividing the view space",
  survey: "timing views",
  candidates: "generating candidates",
  size_model: "learning how large impostors are",
  select: "choosing impostors",
  bake: "recording impostors",
  verify: "checking the result",
  lods: "simplifying objects",
  curves: "measuring error against time",
  assemble: "writing the placement",
  calibrate: "timing frames",
  "verify: pictures": "checking the result: pictures",
  "verify: timing": "checking the result: frame times",
  "verify: rays": "checking the result: rays",
  "quality: rays": "judging the image: rays",
  "quality: pictures": "judging the image: pictures",
};
export const stageText = (stage: string | null) => (stage === null ? "" : (STAGE_TEXT[stage] ?? stage));

/// A job that ended well without its aim is neither a success nor a failure.
export function stateWord(job: Job): string {
  return job.state === "succeeded" && job.aim_met === false ? "finished, aim not met" : job.state;
}

export function stateElement(job: Job): HTMLElement {
  return element("span", { class: `state ${job.state === "succeeded" && job.aim_met === false ? "short" : job.state}` }, stateWord(job));
}

export function progressElement(job: Job): HTMLElement | null {
  if (job.state !== "running") return null;
  const label = `Progress of ${jobTitle(job)}`;
  return job.fraction === null
    ? element("progress", { "aria-label": label })
    : element("progress", { max: 1, value: job.fraction, "aria-label": label });
}

export function tookText(job: Job): string {
  if (job.started === null) return "";
  return duration(((job.finished === null ? Date.now() : Date.parse(job.finished)) - Date.parse(job.started)) / 1000);
}
