// Line charts, drawn by uPlot in the page's own colours, and drawn again when those or the width change.

import uPlot from "uplot";

import { element } from "./elements";
import { isNumber, NONE } from "./text";

export interface Series {
  readonly name: string;
  readonly colour: string;
  readonly values: readonly (number | null)[];
  readonly dash?: number[];
  readonly points?: boolean;
  readonly marksOnly?: boolean;
}
export interface Chart {
  readonly label: string; // for screen readers
  readonly xs: readonly number[];
  readonly x: { readonly label: string; readonly format: (value: number) => string };
  readonly y: { readonly label: string; readonly format: (value: number) => string; readonly log?: boolean }; // log: values > 0
  readonly series: readonly Series[];
}

const colour = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// Of a logarithmic axis only powers of ten are labelled (and, on two decades or less, 2 and 5 times those): others would overlap.
function labelledSplits(splits: readonly number[]): (number | null)[] {
  const wide = (splits.at(-1) ?? 1) / (splits[0] ?? 1) > 200;
  const lead = (value: number) => Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9));
  return splits.map((value) => (lead(value) === 1 || (!wide && [2, 5].includes(lead(value))) ? value : null));
}

function axis(label: string, format: (value: number) => string, size: number, log = false): uPlot.Axis {
  const filter: uPlot.Axis.Filter = (_, splits) => (log ? labelledSplits(splits) : splits);
  const line = { stroke: colour("--line"), width: 1, filter };
  return {
    label,
    labelSize: 22,
    labelFont: "14px system-ui",
    font: "13px system-ui",
    size,
    stroke: colour("--ink"),
    grid: line,
    ticks: line,
    filter,
    values: (_, splits) => splits.map((value) => (value === null ? "" : format(value))),
  };
}

function options(chart: Chart, width: number): uPlot.Options {
  const series = chart.series.map(({ name, colour: variable, dash, points, marksOnly }): uPlot.Series => {
    const stroke = colour(variable);
    return {
      label: name,
      stroke,
      width: 2,
      spanGaps: true,
      points: { show: points === true, size: 7, fill: stroke },
      value: (_, value) => (isNumber(value) ? chart.y.format(value) : NONE),
      ...(dash && { dash }),
      ...(marksOnly === true && { paths: () => null }),
    };
  });
  return {
    width,
    height: 300,
    scales: { x: { time: false }, y: chart.y.log === true ? { distr: 3 } : { range: (_, __, most) => [0, 1.05 * (most || 1)] } },
    axes: [axis(chart.x.label, chart.x.format, 40), axis(chart.y.label, chart.y.format, 74, chart.y.log)],
    series: [{ label: chart.x.label, value: (_, value) => (isNumber(value) ? chart.x.format(value) : NONE) }, ...series],
    cursor: { drag: { x: false, y: false } },
    legend: {
      show: chart.series.length > 1,
      markers: { dash: (_, index) => (chart.series[index - 1]?.dash === undefined ? "solid" : "dotted") },
    },
  };
}

export function lineChart(chart: Chart, signal: AbortSignal): HTMLElement {
  const host = element("div", { class: "chart", role: "img", "aria-label": chart.label });
  let plot: uPlot | null = null;
  const draw = () => {
    plot?.destroy();
    const data = [[...chart.xs], ...chart.series.map(({ values }) => [...values])] as uPlot.AlignedData;
    plot = new uPlot(options(chart, Math.max(240, Math.floor(host.clientWidth))), data, host);
  };
  let width = 0;
  const observer = new ResizeObserver(() => {
    if (host.clientWidth === 0 || host.clientWidth === width) return;
    width = host.clientWidth;
    draw();
  });
  observer.observe(host);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw, { signal });
  signal.addEventListener("abort", () => (observer.disconnect(), plot?.destroy()));
  return host;
}
