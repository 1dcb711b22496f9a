// The parts of a result: from a job's numbers to elements, or nothing where the job has no such numbers.

import { lineChart, type Series } from "../charts";
import { element, section, table } from "../elements";
import type { Placement } from "../runtime/placement";
import { bytes, count, isNumber, milliseconds, percent, significant } from "../text";
import type { Metrics, Unsolved } from "./metrics";
import { tileList, verdictBox, type Tile } from "./summary";

export function verdict(metrics: Metrics): HTMLElement {
  const { cpv, survey, verify } = metrics,
    budget = milliseconds(metrics.budget_ms);
  if (!isNumber(metrics.budget_ms) || metrics.budget_ms === 0 || !isNumber(cpv?.solved))
    return verdictBox("plain", "Survey", `${survey?.verdict ?? "how long frames take, and why"}.`);
  if (cpv.count === 0) return verdictBox("good", "Nothing to do", `no view exceeds ${budget}, so no impostor is needed.`);
  if ((cpv.unsolved ?? 0) > 0)
    return verdictBox(
      "bad",
      "Budget not met everywhere",
      `${count(cpv.unsolved)} of ${count(cpv.count)} slow regions cannot be brought under ${budget}${cpv.solved > 0 ? "; the rest is solved" : ""}.`,
    );
  if ((verify?.over_budget_measured ?? 0) > 0)
    return verdictBox(
      "bad",
      "Bound met, measurements not",
      `every region's bound lies within ${budget}, but ${count(verify!.over_budget_measured)} of ${count(verify!.views)} measured frames were slower.`,
    );
  if (metrics.mode === "sampled")
    return verdictBox("plain", "Budget met by the views that were sampled", "nothing is promised of the others.");
  return verdictBox("good", "Budget met", `the time bound of every view in the view space lies within ${budget}.`);
}

/// What could be saved at most, where there is something to save from.
function memoryNote({ impostors, memory: sizes, bound }: Metrics): string {
  if (impostors?.count === 0 || sizes?.texture_bytes === 0)
    return (sizes?.lods_bytes ?? 0) > 0 ? "levels of detail alone, no impostors" : "no impostors";
  if (!isNumber(bound?.gap)) return "";
  return bound.gap > 0 ? `at most ${percent(bound.gap)} of the textures could be saved` : "no choice of these candidates needs less";
}

function regionsTile(solved: number, all: number, impostors: number): Tile {
  if (all === 0) return { title: "Slow regions", figure: "none" };
  return { title: "Slow regions solved", figure: `${count(solved)} of ${count(all)}`, note: `with ${count(impostors)} impostors` };
}

export function tiles(metrics: Metrics): HTMLElement {
  const { cpv, memory: sizes, survey } = metrics;
  const entries: (Tile | false)[] = [
    isNumber(survey?.worst_bound_ms) && {
      title: "Slowest view",
      figure: milliseconds(survey.worst_bound_ms),
      note: `time bound without impostors; the slowest sampled one takes ${milliseconds(survey.worst_frame_ms)}`,
    },
    isNumber(cpv?.solved) && regionsTile(cpv.solved, cpv.count, metrics.impostors?.count ?? 0),
    isNumber(sizes?.total_bytes) && { title: "Memory", figure: bytes(sizes.total_bytes), note: memoryNote(metrics) },
    isNumber(survey?.reachable_all_ms) && { title: "Lowest budget for all views", figure: milliseconds(survey.reachable_all_ms) },
  ];
  return tileList(entries.filter((entry) => entry !== false));
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

export function memory(metrics: Metrics, placement: Promise<Placement | null>, signal: AbortSignal): HTMLElement | null {
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
  const chart = element("div");
  placement.then(
    (found) => found !== null && found.impostors.length > 1 && chart.append(cumulated(found, signal)),
    () => {}, // the heat map says so
  );
  return section("memory", "Memory", "", chart, totals);
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
