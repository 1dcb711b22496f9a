// The parts of a result: from a job's numbers to elements, or nothing where the job has no such numbers.

import type { Artifact } from "../api";
import { artifactLink } from "../artifact_link";
import { lineChart, type Series } from "../charts";
import { element, section, table } from "../elements";
import { walkAddress } from "../router";
import type { Placement } from "../runtime/placement";
import { bytes, count, isNumber, milliseconds, percent, significant } from "../text";
import type { Metrics, Sweep, SweepPoint, Triple, Unsolved, VerifiedFrame } from "./metrics";

export function verdict(metrics: Metrics): HTMLElement {
  const box = (tone: string, word: string, sentence: string) =>
    element("div", { class: `verdict ${tone}` }, element("strong", {}, word), element("span", {}, sentence));
  const { cpv, survey, verify } = metrics,
    budget = milliseconds(metrics.budget_ms);
  if (!isNumber(metrics.budget_ms) || metrics.budget_ms === 0 || !isNumber(cpv?.solved))
    return box("plain", "Survey", `${survey?.verdict ?? "how long frames take, and why"}.`);
  if (cpv.count === 0) return box("good", "Nothing to do", `no view exceeds ${budget}, so no impostor is needed.`);
  if ((cpv.unsolved ?? 0) > 0)
    return box(
      "bad",
      "Budget not met everywhere",
      `${count(cpv.unsolved)} of ${count(cpv.count)} slow regions cannot be brought under ${budget}; the rest is solved.`,
    );
  if ((verify?.over_budget_measured ?? 0) > 0)
    return box(
      "bad",
      "Bound met, measurements not",
      `every region's bound lies within ${budget}, but ${count(verify!.over_budget_measured)} of ${count(verify!.views)} measured frames were slower.`,
    );
  if (metrics.mode === "sampled") return box("plain", "Budget met by the views that were sampled", "nothing is promised of the others.");
  return box("good", "Budget met", `the time bound of every view in the view space lies within ${budget}.`);
}

export function tiles(metrics: Metrics): HTMLElement {
  const { cpv, memory, bound, survey } = metrics;
  const gap = isNumber(bound?.gap) ? `at most ${percent(bound.gap)} of the textures could be saved` : "";
  const entries: [string, string, string][] = [];
  if (isNumber(survey?.worst_bound_ms))
    entries.push([
      "Slowest view",
      milliseconds(survey.worst_bound_ms),
      `time bound without impostors; the slowest sampled one takes ${milliseconds(survey.worst_frame_ms)}`,
    ]);
  if (isNumber(cpv?.solved))
    entries.push([
      "Slow regions solved",
      `${count(cpv.solved)} of ${count(cpv.count)}`,
      `with ${count(metrics.impostors?.count ?? 0)} impostors`,
    ]);
  if (isNumber(memory?.total_bytes)) entries.push(["Memory", bytes(memory.total_bytes), gap]);
  if (isNumber(survey?.reachable_all_ms)) entries.push(["Lowest budget for all views", milliseconds(survey.reachable_all_ms), ""]);
  return element(
    "dl",
    { class: "tiles" },
    ...entries.map(([title, figure, note]) =>
      element(
        "div",
        { class: "tile" },
        element("dt", {}, title),
        element("dd", { class: "figure" }, figure),
        note !== "" && element("dd", { class: "note" }, note),
      ),
    ),
  );
}

const FRAMES: readonly {
  key: "before_ms" | "after_ms" | "estimated_before_ms" | "estimated_after_ms";
  name: string;
  colour: string;
  dash?: number[];
}[] = [
  { key: "estimated_before_ms", name: "before, estimated", colour: "--before", dash: [4, 4] },
  { key: "estimated_after_ms", name: "with impostors, estimated", colour: "--after", dash: [4, 4] },
  { key: "before_ms", name: "before, measured", colour: "--before" },
  { key: "after_ms", name: "with impostors, measured", colour: "--after" },
];

const quantile = (sorted: readonly number[], share: number) =>
  sorted[Math.min(sorted.length - 1, Math.max(0, Math.ceil(share * sorted.length) - 1))]!;

export function frameTimes(metrics: Metrics, signal: AbortSignal): HTMLElement | null {
  const frames = metrics.verify?.frames ?? [];
  const known = FRAMES.map((series) => ({
    ...series,
    sorted: frames
      .map((frame) => frame[series.key])
      .filter(isNumber)
      .sort((a, b) => a - b),
  })).filter(({ sorted }) => sorted.length > 0);
  if (known.length === 0) return null;
  const steps = Math.min(400, 2 * frames.length),
    shares = Array.from({ length: steps + 1 }, (_, index) => (100 * index) / steps);
  const curves: Series[] = known.map(({ sorted, ...series }) => ({
    ...series,
    values: shares.map((share) => quantile(sorted, share / 100)),
  }));
  const budget: Series[] = isNumber(metrics.budget_ms)
    ? [{ name: "budget", colour: "--budget", dash: [2, 3], values: shares.map(() => metrics.budget_ms!) }]
    : [];
  const format = (value: number) => significant(value, 3);
  const chart = lineChart(
    {
      label: `Frame times of ${frames.length} views, sorted, before and with impostors`,
      xs: shares,
      series: [...curves, ...budget],
      x: { label: "share of views at most as slow, %", format },
      y: { label: "frame time, ms", format },
    },
    signal,
  );
  const columns = [
    { title: "frame time", cell: (row: (typeof known)[number]) => row.name },
    ...(
      [
        ["median", 0.5],
        ["99th percentile", 0.99],
        ["worst", 1],
      ] as const
    ).map(([title, share]) => ({ title, number: true, cell: (row: (typeof known)[number]) => milliseconds(quantile(row.sorted, share)) })),
  ];
  return section(
    "frames",
    "Frame times",
    `${count(frames.length)} views drawn with and without impostors: random ones inside the slow regions, and the hardest we know.`,
    element("figure", {}, chart),
    table(columns, known, "Frame time percentiles"),
  );
}

export function memory(metrics: Metrics, placement: Placement | null, signal: AbortSignal): HTMLElement | null {
  const { memory: sizes, bound } = metrics;
  if (!isNumber(sizes?.total_bytes) || sizes.total_bytes === 0) return null;
  const rows = (
    [
      ["textures, with gutters (the objective)", sizes.texture_bytes],
      ["geometry", sizes.geometry_bytes],
      ["levels of detail", sizes.lods_bytes],
      ["unused space in the atlases", sizes.atlas_padding_bytes],
      ["total", sizes.total_bytes],
      ["lower bound: no choice of these candidates needs less", bound?.memory_lower_bound_bytes],
    ] as const
  ).filter(([, size]) => isNumber(size));
  const totals = table(
    [
      { title: "memory", cell: (row: (typeof rows)[number]) => row[0] },
      { title: "", number: true, cell: (row) => bytes(row[1]) },
    ],
    rows,
    "Memory",
  );
  return section("memory", "Memory", "", placement !== null && placement.impostors.length > 1 && cumulated(placement, signal), totals);
}

/// How much of the memory the largest impostors take.
function cumulated(placement: Placement, signal: AbortSignal): HTMLElement {
  const sizes = placement.impostors.map((impostor) => impostor.texture_bytes).sort((a, b) => b - a);
  let sum = 0;
  const values = sizes.map((size) => (sum += size));
  const chart = lineChart(
    {
      label: `Texture memory of ${sizes.length} impostors, largest first, added up`,
      xs: sizes.map((_, index) => index + 1),
      series: [{ name: "textures", colour: "--after", values }],
      x: { label: "impostors, largest first", format: count },
      y: { label: "textures, added up", format: bytes },
    },
    signal,
  );
  return element("figure", {}, chart);
}

export function causes({ causes: found }: Metrics): HTMLElement | null {
  const objects = found?.objects ?? [];
  if (found === undefined || objects.length === 0) return null;
  const work = `${percent(found.triangles_share)} goes into triangles, ${percent(found.pixels_share)} into pixels, ${percent(found.draws_share)} into draw calls.`;
  const columns = [
    { title: "object", cell: (row: (typeof objects)[number]) => row.name },
    { title: "time over all slow cells", number: true, cell: (row: (typeof objects)[number]) => milliseconds(row.ms) },
  ];
  return section(
    "causes",
    "Why it is slow",
    `Of the time where the budget is exceeded, ${work}`,
    table(columns, objects, "Objects that cost most"),
  );
}

interface WorstView {
  readonly name: string;
  readonly position: Triple;
  readonly direction: Triple;
  readonly before: number | null;
  readonly after: number | null;
  readonly flip: number | null;
}

const measured = (frame: VerifiedFrame, when: "before" | "after") => frame[`${when}_ms`] ?? frame[`estimated_${when}_ms`];

export function worstViews(metrics: Metrics, walkId: string | null, report: Artifact | undefined): HTMLElement | null {
  const surveyed = (metrics.survey?.worst_views ?? [])
    .slice(0, 8)
    .map((view, i): WorstView => ({ ...view, name: `slowest of the survey, ${i + 1}`, before: view.frame_ms, after: null, flip: null }));
  const verified = [...(metrics.verify?.frames ?? [])]
    .sort((a, b) => (measured(b, "after") ?? 0) - (measured(a, "after") ?? 0))
    .slice(0, 8)
    .map((frame): WorstView => ({
      ...frame,
      name: `drawn with impostors (${frame.origin})`,
      before: measured(frame, "before"),
      after: measured(frame, "after"),
      flip: frame.mean_flip,
    }));
  const views = [...verified, ...surveyed];
  if (views.length === 0) return null;
  const position = (view: WorstView) => view.position.map((value) => significant(value, 4)).join(", ");
  const compared =
    verified.length === 0
      ? []
      : [
          { title: "with impostors", number: true, cell: (view: WorstView) => milliseconds(view.after) },
          { title: "image error (FLIP)", number: true, cell: (view: WorstView) => significant(view.flip, 2) },
        ];
  const columns = [
    { title: "view", cell: (view: WorstView) => view.name },
    { title: "position, m", cell: position },
    { title: "before", number: true, cell: (view: WorstView) => milliseconds(view.before) },
    ...compared,
    ...(walkId === null
      ? []
      : [
          {
            title: "",
            cell: (view: WorstView) =>
              element(
                "a",
                { href: walkAddress(walkId, view.position, view.direction), "aria-label": `walk there: ${position(view)}` },
                "walk there",
              ),
          },
        ]),
  ];
  const lead = walkId === null ? "" : "In the walk, the key I shows each view with and without its impostors.";
  return section(
    "views",
    "Worst views",
    lead,
    table(columns, views, "Worst views"),
    verified.length > 0 &&
      report !== undefined &&
      element("p", { class: "soft" }, "Side by side, with their differences: ", artifactLink(report, "report.html"), "."),
  );
}

export function unsolved(metrics: Metrics): HTMLElement | null {
  const rows = metrics.unsolved ?? [];
  if (rows.length === 0) return null;
  const columns = [
    { title: "region", number: true, cell: (row: Unsolved) => String(row.cpv) },
    { title: "where", cell: (row: Unsolved) => row.region ?? "" },
    { title: "bound before", number: true, cell: (row: Unsolved) => milliseconds(row.bound_before_ms) },
    { title: "lowest budget that can be met", number: true, cell: (row: Unsolved) => milliseconds(row.lowest_budget_ms) },
    { title: "because of", cell: (row: Unsolved) => (row.blocking ?? []).map(({ name, object }) => name ?? `object ${object}`).join(", ") },
  ];
  return section(
    "unsolved",
    "Regions without a solution",
    "In these regions no set of impostors keeps the frame within the budget: the objects named are too near, or too deep, for an impostor. Raise the budget, leave the place out of the view space, or simplify or split these objects.",
    table(columns, rows, "Unsolved regions"),
  );
}

export function sweepCurve(sweep: Sweep, signal: AbortSignal): HTMLElement {
  const points = [...sweep.points].sort((a, b) => a.budget_ms - b.budget_ms),
    at = (holds: (point: SweepPoint) => boolean) => points.map((point) => (holds(point) ? point.texture_bytes : null));
  const series: Series[] = [
    { name: "textures", colour: "--after", points: true, values: at((point) => point.met) },
    { name: "textures, some views unsolved", colour: "--bad", points: true, values: at((point) => !point.met) },
    { name: "lower bound", colour: "--soft", dash: [3, 4], values: points.map((point) => point.memory_lower_bound_bytes) },
  ].filter(({ values }) => values.some(isNumber));
  const chart = lineChart(
    {
      label: `Memory of the textures against the frame-time budget, at ${points.length} budgets`,
      xs: points.map((point) => point.budget_ms),
      series,
      x: { label: "frame-time budget, ms", format: (value) => significant(value, 4) },
      y: { label: "memory", format: bytes },
    },
    signal,
  );
  const columns = [
    { title: "budget", number: true, cell: (point: SweepPoint) => milliseconds(point.budget_ms) },
    { title: "outcome", cell: (point: SweepPoint) => (point.met ? "met" : `${count(point.cpv.unsolved)} unsolved`) },
    { title: "impostors", number: true, cell: (point: SweepPoint) => count(point.impostors) },
    { title: "textures", number: true, cell: (point: SweepPoint) => bytes(point.texture_bytes) },
    { title: "total", number: true, cell: (point: SweepPoint) => bytes(point.total_bytes) },
  ];
  return section(
    "curve",
    "Memory against the budget",
    `Budgets: ${sweep.budgets_from}.`,
    element("figure", {}, chart),
    table(columns, points, "Points of the curve"),
  );
}
