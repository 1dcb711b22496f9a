// A sweep's result: memory against the frame-time budget.

import { lineChart, type Series } from "../charts";
import { element, section, table } from "../elements";
import { bytes, count, isNumber, milliseconds, significant } from "../text";
import type { Sweep, SweepPoint } from "./metrics";
import { verdictBox } from "./summary";
import { failedGate } from "./sweep_gates";

/// What the sweep is held against comes first; then how low the budget can go, and what that takes.
export function sweepVerdict(sweep: Sweep): HTMLElement {
  return failedGate(sweep) ?? budgetsVerdict(sweep);
}

function budgetsVerdict({ points, passed }: Sweep): HTMLElement {
  const met = points.filter((point) => point.met).sort((a, b) => a.budget_ms - b.budget_ms);
  const [lowest] = met;
  if (lowest === undefined) return verdictBox("bad", "No budget met", `at each of ${count(points.length)} budgets some regions stay slow.`);
  const takes = `the lowest that is met, ${milliseconds(lowest.budget_ms)}, takes ${bytes(lowest.texture_bytes)} of textures.`;
  return passed && met.length === points.length
    ? verdictBox("good", "Every budget met", takes)
    : verdictBox("plain", `${count(met.length)} of ${count(points.length)} budgets met`, takes);
}

/// A logarithmic axis has no place for 0.
const positive = (value: number) => (value > 0 ? value : null);

function curve(points: readonly SweepPoint[], signal: AbortSignal): HTMLElement | null {
  const at = (holds: (point: SweepPoint) => boolean) => points.map((point) => (holds(point) ? positive(point.texture_bytes) : null));
  const series: Series[] = [
    { name: "textures", colour: "--after", points: true, values: at((point) => point.met) },
    { name: "textures, some views unsolved", colour: "--bad", points: true, marksOnly: true, values: at((point) => !point.met) },
    { name: "lower bound", colour: "--soft", dash: [3, 4], values: points.map((point) => positive(point.memory_lower_bound_bytes)) },
  ].filter(({ values }) => values.some(isNumber));
  if (series.length === 0) return null;
  const chart = lineChart(
    {
      label: `Memory of the textures against the frame-time budget, at ${points.length} budgets`,
      xs: points.map((point) => point.budget_ms),
      series,
      x: { label: "frame-time budget, ms", format: (value) => significant(value, 4) },
      y: { label: "memory", format: bytes, log: true },
    },
    signal,
  );
  return element("figure", {}, chart);
}

function outcome({ met, cpv }: SweepPoint): string {
  if (!met) return `${count(cpv.unsolved)} unsolved`;
  return cpv.count === 0 ? "nothing to place" : "met";
}

export function sweepCurve(sweep: Sweep, signal: AbortSignal): HTMLElement {
  const points = [...sweep.points].sort((a, b) => a.budget_ms - b.budget_ms);
  const columns = [
    { title: "budget", number: true, cell: (point: SweepPoint) => milliseconds(point.budget_ms) },
    { title: "outcome", cell: outcome },
    { title: "impostors", number: true, cell: (point: SweepPoint) => count(point.impostors) },
    { title: "textures", number: true, cell: (point: SweepPoint) => bytes(point.texture_bytes) },
    { title: "lower bound", number: true, cell: (point: SweepPoint) => bytes(point.memory_lower_bound_bytes) },
    { title: "total", number: true, cell: (point: SweepPoint) => bytes(point.total_bytes) },
  ];
  return section(
    "curve",
    "Memory against the budget",
    `Budgets: ${sweep.budgets_from}. Each is placed by itself; no choice of the same candidates needs less than the lower bound.`,
    curve(points, signal),
    table(columns, points, "Points of the curve"),
  );
}
