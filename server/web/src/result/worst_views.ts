// The worst views: side by side where the job left pictures, and all in numbers, with a way into the walk from each.

import { artifactOf, type Job } from "../api";
import { artifactLink } from "../artifact_link";
import { element, folded, section, table } from "../elements";
import { milliseconds, significant } from "../text";
import type { Metrics, Triple } from "./metrics";
import { frameTime, placeText, sideBySide, walkLink } from "./side_by_side";

const MOST = 8; // of each kind

interface WorstView {
  readonly name: string;
  readonly position: Triple;
  readonly direction: Triple;
  readonly before: number | null;
  readonly after: number | null;
  readonly flip: number | null;
}

const surveyedViews = (metrics: Metrics): WorstView[] =>
  (metrics.survey?.worst_views ?? [])
    .slice(0, MOST)
    .map((view, i) => ({ ...view, name: `slowest of the survey, ${i + 1}`, before: view.frame_ms, after: null, flip: null }));

const verifiedViews = (metrics: Metrics): WorstView[] =>
  [...(metrics.verify?.frames ?? [])]
    .sort((a, b) => (frameTime(b, "after") ?? 0) - (frameTime(a, "after") ?? 0))
    .slice(0, MOST)
    .map((frame) => ({
      ...frame,
      name: `drawn with impostors (${frame.origin})`,
      before: frameTime(frame, "before"),
      after: frameTime(frame, "after"),
      flip: frame.mean_flip,
    }));

function viewTable(views: readonly WorstView[], compared: boolean, walkId: string | null): HTMLElement {
  const comparison = [
    { title: "with impostors", number: true, cell: (view: WorstView) => milliseconds(view.after) },
    { title: "image error (FLIP)", number: true, cell: (view: WorstView) => significant(view.flip, 2) },
  ];
  const columns = [
    { title: "view", cell: (view: WorstView) => view.name },
    { title: "position, m", cell: (view: WorstView) => placeText(view.position) },
    { title: "before", number: true, cell: (view: WorstView) => milliseconds(view.before) },
    ...(compared ? comparison : []),
    ...(walkId === null ? [] : [{ title: "", cell: (view: WorstView) => walkLink(walkId, view) }]),
  ];
  return table(columns, views, "Worst views");
}

const PICTURES_LEAD =
  "The views with the largest image error and the slowest ones, as they are, with their impostors, and the difference of the two. A picture opens in full size.";
const WALK_LEAD = "In the walk, the key I shows each view with and without its impostors.";

export interface WorstViewsOptions {
  readonly metrics: Metrics;
  readonly walkId: string | null; // null: nothing to walk through
  readonly job: Job;
  readonly signal: AbortSignal;
}

export function worstViews({ metrics, walkId, job, signal }: WorstViewsOptions): HTMLElement | null {
  const verified = verifiedViews(metrics),
    views = [...verified, ...surveyedViews(metrics)];
  const figures = sideBySide({ verify: metrics.verify, artifacts: job.artifacts, walkId, signal });
  if (views.length === 0 && figures.length === 0) return null;
  const numbers = viewTable(views, verified.length > 0, walkId);
  const report = artifactOf(job, "report.html");
  const elsewhere =
    figures.length === 0 && verified.length > 0 && report !== undefined
      ? element("p", { class: "soft" }, "Side by side, with their differences: ", artifactLink(report, "report.html"), ".")
      : null;
  const lead = [figures.length > 0 && PICTURES_LEAD, walkId !== null && WALK_LEAD].filter(Boolean).join(" ");
  return section(
    "views",
    figures.length > 0 ? "Worst views side by side" : "Worst views",
    lead,
    ...figures,
    figures.length > 0 ? folded("These and more as a table", numbers) : numbers,
    elsewhere,
  );
}
