// A calibration's result (target.json): how well frame times are predicted on its machine, what each kind of work costs there, and what more
// calibration would buy.

import { lineChart } from "../charts";
import { element, factList, section, table } from "../elements";
import { count, isNumber, milliseconds, percent, significant } from "../text";
import { tileList, verdictBox } from "./summary";

interface LearningPoint {
  readonly seconds: number;
  readonly frames: number;
  readonly median_error: number;
  readonly p90_error: number;
  readonly coverage: number;
  readonly bound_over_measured_median: number;
}
export interface Target {
  readonly id: string;
  readonly machine: Readonly<Record<string, string | number>>;
  readonly model: {
    readonly milliseconds_per_unit: Readonly<Record<string, number>>;
    readonly combination: string;
    readonly bound_steps: readonly { readonly until_ms: number | null; readonly factor: number }[];
    readonly coverage: number;
  };
  readonly quality: {
    readonly samples: number;
    readonly median_error: number;
    readonly p90_error: number;
    readonly measured_coverage: number;
    readonly left_out?: readonly string[];
    readonly learning_curve?: readonly LearningPoint[];
  };
}

/// A term of the time model: what one unit is, and of how many the cost is told, so that it reads in milliseconds.
interface Term {
  readonly counts: string;
  readonly per: number;
}
const MILLION = 1e6;
const TERMS: Record<string, Term> = {
  frame: { counts: "frame, whatever is in it", per: 1 },
  draws: { counts: "draw calls", per: 1000 },
  texture_switches: { counts: "switches between impostors' atlas pages", per: 1000 },
  triangles: { counts: "triangles submitted", per: MILLION },
  on_screen_triangles: { counts: "triangles on screen, beside their submission", per: MILLION },
  edge_pixels: { counts: "pixels along triangles' edges", per: MILLION },
  plain_pixels: { counts: "pixels without texture that pass the depth test", per: MILLION },
  textured_pixels: { counts: "pixels with texture that pass", per: MILLION },
  masked_pixels: { counts: "alpha-tested pixels that pass", per: MILLION },
  impostor_quads: { counts: "impostors' quads", per: 1000 },
  impostor_pixels: { counts: "impostors' pixels", per: MILLION },
};
const MACHINE: Record<string, string> = {
  processor: "processor",
  renderer: "renderer",
  gl_version: "OpenGL",
  device: "device",
  clock: "clock",
  reference_ms: "reference frame",
};

function verdict({ model, quality }: Target, aimMet: boolean | null): HTMLElement {
  const errors = `Half of the frames of scenes held out are predicted within ${percent(quality.median_error)}, nine of ten within ${percent(quality.p90_error)}.`;
  const bounds = `${percent(quality.measured_coverage)} of them kept their bound, ${percent(model.coverage)} is stated.`;
  const more = "More seconds may mend that.";
  if (aimMet === false) return verdictBox("bad", "Calibrated, aim not met", `${errors} ${bounds} ${more}`);
  if (quality.measured_coverage < model.coverage) return verdictBox("plain", "Calibrated", `${errors} Only ${bounds} ${more}`);
  return verdictBox("good", "Calibrated", `${errors} ${bounds}`);
}

function tiles({ model, quality }: Target): HTMLElement {
  return tileList([
    { title: "Median error", figure: percent(quality.median_error), note: "of predicted frame times, held out scene by scene" },
    { title: "90th percentile error", figure: percent(quality.p90_error), note: "likewise" },
    { title: "Frames within their bound", figure: percent(quality.measured_coverage), note: `${percent(model.coverage)} is stated` },
    { title: "Frames timed", figure: count(quality.samples) },
  ]);
}

function costs({ model, quality }: Target): HTMLElement {
  const known = Object.keys(TERMS),
    given = Object.keys(model.milliseconds_per_unit);
  const names = [...known.filter((name) => given.includes(name)), ...given.filter((name) => !known.includes(name))];
  const rows = names.map((name) => ({ ms: model.milliseconds_per_unit[name]!, ...(TERMS[name] ?? { counts: name, per: 1 }) }));
  type Row = (typeof rows)[number];
  const columns = [
    { title: "work", cell: ({ counts }: Row) => counts },
    { title: "cost", number: true, cell: ({ ms, per }: Row) => milliseconds(ms * per) },
    { title: "of", number: true, cell: ({ per }: Row) => (per === 1 ? "each" : per === MILLION ? "a million" : "a thousand") },
    { title: "ms per unit", number: true, cell: ({ ms }: Row) => significant(ms, 4) },
  ];
  const combined =
    model.combination === "max"
      ? "Geometry and fill overlap on this machine: the longer of the two counts."
      : "A frame takes the sum of these.";
  return section(
    "costs",
    "What work costs",
    `${combined} ${boundText(model.bound_steps)}`,
    table(columns, rows, "Costs of the time model"),
    leftOut(quality.left_out),
  );
}

function boundText(steps: Target["model"]["bound_steps"]): string {
  const [first, ...more] = steps.map(
    ({ until_ms, factor }) =>
      `${significant(factor, 3)} times the prediction${until_ms === null ? "" : ` up to ${milliseconds(until_ms)}`}`,
  );
  return first === undefined ? "" : `The time bound is ${[first, ...more].join(", then ")}.`;
}

/// Sentences that begin with the term that was left out.
function leftOut(sentences: readonly string[] = []): HTMLElement | null {
  if (sentences.length === 0) return null;
  const inWords = (text: string) => text.replace(/^\w+(?=:)/, (name) => TERMS[name]?.counts ?? name);
  return element("div", {}, element("h3", {}, "Left out"), element("ul", {}, ...sentences.map((text) => element("li", {}, inWords(text)))));
}

function learning({ quality }: Target, signal: AbortSignal): HTMLElement | null {
  const points = [...(quality.learning_curve ?? [])].sort((a, b) => a.seconds - b.seconds);
  if (points.length === 0) return null;
  const chart = lineChart(
    {
      label: `Error of predicted frame times against seconds of calibration, at ${points.length} times`,
      xs: points.map(({ seconds }) => seconds),
      series: [
        { name: "90th percentile error", colour: "--before", points: true, values: points.map(({ p90_error }) => p90_error) },
        { name: "median error", colour: "--after", points: true, values: points.map(({ median_error }) => median_error) },
      ],
      x: { label: "seconds of calibration", format: (value) => significant(value, 3) },
      y: { label: "error, held out", format: percent },
    },
    signal,
  );
  const columns = [
    { title: "seconds", number: true, cell: (point: LearningPoint) => significant(point.seconds, 3) },
    { title: "frames", number: true, cell: (point: LearningPoint) => count(point.frames) },
    { title: "median error", number: true, cell: (point: LearningPoint) => percent(point.median_error) },
    { title: "90th percentile", number: true, cell: (point: LearningPoint) => percent(point.p90_error) },
    { title: "within bound", number: true, cell: (point: LearningPoint) => percent(point.coverage) },
    { title: "bound / measured", number: true, cell: (point: LearningPoint) => significant(point.bound_over_measured_median, 3) },
  ];
  return section(
    "learning",
    "What more calibration would buy",
    "How well the first seconds of this calibration alone would have done.",
    points.length > 1 && element("figure", {}, chart),
    table(columns, points, "Errors by seconds of calibration"),
  );
}

function machine({ machine: measured }: Target): HTMLElement {
  const entries = Object.entries(MACHINE).filter(([key]) => measured[key] !== undefined);
  const text = (value: string | number | undefined) => (isNumber(value) ? milliseconds(value) : String(value));
  return section(
    "machine",
    "Where it holds",
    "Frames can be timed against it on this device and renderer; elsewhere their times are estimated from it.",
    factList(entries.map(([key, name]) => [name, text(measured[key])])),
  );
}

export function targetView(target: Target, aimMet: boolean | null, ways: HTMLElement, signal: AbortSignal): (HTMLElement | null)[] {
  return [
    element("p", { class: "context" }, target.id),
    verdict(target, aimMet),
    tiles(target),
    ways,
    costs(target),
    learning(target, signal),
    machine(target),
  ];
}
