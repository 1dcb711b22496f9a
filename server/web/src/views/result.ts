// A finished job's result: how it went, where the scene is slow, what it costs, and ways into the walk.

import { artifactOf, getJob, getText, isFinal, isWalkable, type Job } from "../api";
import { artifactLink } from "../artifact_link";
import { element, folded, section } from "../elements";
import { jobTitle, stateWord } from "../job_text";
import { problemBox } from "../problem";
import { heatMap } from "../result/heat_map";
import type { Metrics, Sweep } from "../result/metrics";
import { causes, frameTimes, memory, sweepCurve, tiles, unsolved, verdict, worstViews } from "../result/sections";
import { jobAddress, type Route } from "../router";
import { parsePlacement, type Placement } from "../runtime/placement";
import { count, isNumber, milliseconds } from "../text";

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

function ways(job: Job): HTMLElement {
  const report = artifactOf(job, "report.html");
  return element(
    "div",
    { class: "actions" },
    isWalkable(job) && element("a", { class: "button primary", href: jobAddress(job.id, "walk") }, "Walk through it"),
    report !== undefined && artifactLink(report, "The whole report", { class: "button" }),
    element("a", { class: "button", href: jobAddress(job.id) }, "Job and files"),
  );
}

function numbers(job: Job, metrics: Metrics, placement: Placement | null, signal: AbortSignal): (HTMLElement | null)[] {
  const walkId = placement !== null && isWalkable(job) ? job.id : null;
  return [
    element("p", { class: "context" }, context(metrics)),
    verdict(metrics),
    tiles(metrics),
    ways(job),
    heatMap({ metrics, placement, walkId }),
    frameTimes(metrics, signal),
    worstViews(metrics, walkId, artifactOf(job, "report.html")),
    unsolved(metrics),
    causes(metrics),
    memory(metrics, placement, signal),
  ];
}

/// What has no view of its own is shown as it is.
async function plain(job: Job, signal: AbortSignal): Promise<HTMLElement[]> {
  const files = job.artifacts.filter(({ type, path }) => type.startsWith("application/json") || path.endsWith(".json"));
  return Promise.all(
    files.map(async (file) =>
      section(
        file.path,
        file.path,
        "",
        folded(
          "Numbers",
          element("pre", { class: "scroll", tabindex: 0 }, JSON.stringify(parsed(await getText(file.href, signal)), null, 2)),
        ),
      ),
    ),
  );
}

export async function showResult(host: HTMLElement, { id }: Route, signal: AbortSignal): Promise<void> {
  document.title = "Result \u2014 Standin";
  const status = element("p", { role: "status" }, "Loading the result");
  host.append(status);
  const job = await getJob(id, signal);
  const name = jobTitle(job);
  document.title = `Result: ${name} \u2014 Standin`;
  const [metrics, sweep, placement] = await Promise.all([
    artifact(job, "metrics.json", parsed<Metrics>, signal),
    artifact(job, "sweep.json", parsed<Sweep>, signal),
    artifact(job, "placement.json", parsePlacement, signal),
  ]);
  if (signal.aborted) return;
  host.replaceChildren(element("h1", {}, name));
  if (job.artifacts.length === 0) host.append(noResult(job));
  else if (sweep !== null) host.append(ways(job), sweepCurve(sweep, signal));
  else if (metrics !== null && job.kind !== "bake")
    host.append(...numbers(job, metrics, placement, signal).filter((node) => node !== null));
  else host.append(ways(job), ...(await plain(job, signal)));
}
