// A finished job's result, by its kind: how it went, what it costs, and ways into the walk.

import { artifactOf, getJob, getText, isFinal, isWalkable, type Job, type JobKind } from "../api";
import { artifactLink } from "../artifact_link";
import { element, folded, section } from "../elements";
import { jobTitle, stateWord } from "../job_text";
import { problemBox } from "../problem";
import { bakedView, impostorLink, type Baked } from "../result/baked";
import { heatMap } from "../result/heat_map";
import type { Metrics, Sweep } from "../result/metrics";
import { causes, frameTimes, memory, tiles, unsolved, verdict } from "../result/sections";
import { sweepCurve, sweepVerdict } from "../result/sweep";
import { criteria, sinceBaseline } from "../result/sweep_gates";
import { targetView, type Target } from "../result/target";
import { imageErrors, verificationTiles, verificationVerdict, type Verification } from "../result/verification";
import { worstViews } from "../result/worst_views";
import { jobAddress, type Route } from "../router";
import { parsePlacement } from "../runtime/placement";
import { count, isNumber, milliseconds } from "../text";

type Shown = (HTMLElement | null)[];

async function artifact<T>(job: Job, path: string, read: (text: string) => T, signal: AbortSignal): Promise<T | null> {
  const found = artifactOf(job, path);
  return found === undefined ? null : read(await getText(found.href, signal));
}
const parsed = <T>(text: string) => JSON.parse(text) as T;

function noResult(job: Job): HTMLElement {
  const back = element("p", {}, element("a", { href: jobAddress(job.id) }, "To the job"));
  if (job.error !== null) return element("div", {}, problemBox(job.error), back);
  const text = isFinal(job.state)
    ? "It left no files, so there is nothing to show."
    : "Results appear all at once when the job has finished.";
  return element("div", { class: "empty" }, element("h2", {}, `This job is ${stateWord(job)}`), element("p", {}, text), back);
}

function context(metrics: Metrics): string {
  return [
    metrics.scene && `${count(metrics.scene.objects)} objects, ${count(metrics.scene.triangles)} triangles`,
    isNumber(metrics.budget_ms) && metrics.budget_ms > 0 && `budget ${milliseconds(metrics.budget_ms)}`,
    metrics.target && `on ${metrics.target.id}`,
  ]
    .filter((part) => typeof part === "string")
    .join(" \u00b7 ");
}

/// Ways out of the result; `own` is the kind's.
function ways(job: Job, ...own: (HTMLElement | null)[]): HTMLElement {
  const report = artifactOf(job, "report.html");
  return element(
    "div",
    { class: "actions" },
    ...own,
    isWalkable(job) && element("a", { class: "button primary", href: jobAddress(job.id, "walk") }, "Walk through it"),
    report !== undefined && artifactLink(report, "The whole report", { class: "button" }),
    element("a", { class: "button", href: jobAddress(job.id) }, "Job and files"),
  );
}

async function placed(job: Job, signal: AbortSignal): Promise<Shown | null> {
  const placement = artifact(job, "placement.json", parsePlacement, signal); // large: the numbers are shown before it has come
  placement.catch(() => {}); // whoever waits for it says so
  const metrics = await artifact(job, "metrics.json", parsed<Metrics>, signal);
  if (metrics === null) return null;
  const walkId = isWalkable(job) && artifactOf(job, "placement.json") !== undefined ? job.id : null;
  return [
    element("p", { class: "context" }, context(metrics)),
    verdict(metrics),
    tiles(metrics),
    ways(job),
    heatMap(metrics, placement, walkId),
    frameTimes(metrics, signal),
    worstViews({ metrics, walkId, job, signal }),
    unsolved(metrics),
    causes(metrics),
    memory(metrics, placement, signal),
  ];
}

async function swept(job: Job, signal: AbortSignal): Promise<Shown | null> {
  const sweep = await artifact(job, "sweep.json", parsed<Sweep>, signal);
  return (
    sweep && [
      element("p", { class: "context" }, context(sweep)),
      sweepVerdict(sweep),
      ways(job),
      sweepCurve(sweep, signal),
      sinceBaseline(sweep),
      criteria(sweep),
    ]
  );
}

async function calibrated(job: Job, signal: AbortSignal): Promise<Shown | null> {
  const target = await artifact(job, "target.json", parsed<Target>, signal);
  const file = artifactOf(job, "target.json");
  const download = file === undefined ? null : artifactLink(file, "target.json", { save: true, class: "button primary" });
  return target && targetView(target, job.aim_met, ways(job, download), signal);
}

interface Placed {
  readonly job: Job;
  readonly metrics: Metrics | null;
}

/// The placement that was verified; it may have been deleted since.
async function verifiedPlacement(job: Job, signal: AbortSignal): Promise<Placed | null> {
  if (job.request.job === undefined) return null;
  try {
    const found = await getJob(job.request.job, signal);
    return { job: found, metrics: await artifact(found, "metrics.json", parsed<Metrics>, signal) };
  } catch {
    return null;
  }
}

function placementLink(found: Placed | null): HTMLElement {
  if (found === null) return element("p", { class: "context" }, "The placement that was verified is gone.");
  const link = element("a", { href: jobAddress(found.job.id, "result") }, jobTitle(found.job));
  return element("p", { class: "context" }, "Of ", link, found.metrics === null ? "" : ` \u00b7 ${context(found.metrics)}`);
}

async function verified(job: Job, signal: AbortSignal): Promise<Shown | null> {
  const [result, of] = await Promise.all([artifact(job, "verify.json", parsed<Verification>, signal), verifiedPlacement(job, signal)]);
  if (result === null) return null;
  const budget_ms = of?.metrics?.budget_ms;
  const metrics: Metrics = { verify: result.verify, ...(isNumber(budget_ms) && { budget_ms }) };
  return [
    placementLink(of),
    verificationVerdict(result, job.aim_met, isNumber(budget_ms) ? milliseconds(budget_ms) : undefined),
    verificationTiles(result),
    ways(job),
    frameTimes(metrics, signal),
    worstViews({ metrics, walkId: of !== null && isWalkable(of.job) ? of.job.id : null, job, signal }),
    imageErrors(result),
  ];
}

async function baked(job: Job, signal: AbortSignal): Promise<Shown | null> {
  const result = await artifact(job, "metrics.json", parsed<Baked>, signal);
  return result && bakedView(result, job, ways(job, impostorLink(job)), signal);
}

const SHOWN: Partial<Record<JobKind, (job: Job, signal: AbortSignal) => Promise<Shown | null>>> = {
  place: placed,
  survey: placed,
  sweep: swept,
  calibrate: calibrated,
  verify: verified,
  bake: baked,
};

/// What has no view of its own is shown as it is.
async function plain(job: Job, signal: AbortSignal): Promise<Shown> {
  const files = job.artifacts.filter(({ type, path }) => type.startsWith("application/json") || path.endsWith(".json"));
  const sections = files.map(async (file) => {
    const numbers = JSON.stringify(parsed(await getText(file.href, signal)), null, 2);
    return section(file.path, file.path, "", folded("Numbers", element("pre", { class: "scroll", tabindex: 0 }, numbers)));
  });
  return [ways(job), ...(await Promise.all(sections))];
}

export async function showResult(host: HTMLElement, { id }: Route, signal: AbortSignal): Promise<void> {
  document.title = "Result \u2014 Standin";
  const status = element("p", { role: "status" }, "Loading the result");
  host.append(status);
  const job = await getJob(id, signal);
  document.title = `Result: ${jobTitle(job)} \u2014 Standin`;
  const shown = job.artifacts.length === 0 ? [noResult(job)] : ((await SHOWN[job.kind]?.(job, signal)) ?? (await plain(job, signal)));
  if (signal.aborted) return;
  host.replaceChildren(element("h1", {}, jobTitle(job)), ...shown.filter((node) => node !== null));
}
