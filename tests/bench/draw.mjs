// Figures for the pages beside the benches: curves of one quantity against another, drawn to SVG without a browser.
//
//     npm ci --prefix tests/bench                         once; neither build nor tests need it
//     node tests/bench/draw.mjs FIGURE.json [FIGURE.svg]
//     node tests/bench/draw.mjs TABLE.csv FIGURE.svg [--title T] [--y LABEL] [--log x|y|xy]
//     node tests/bench/draw.mjs --curves NAME=METRICS.json.. FIGURE.svg
//
// The last draws the curves of error against run time that `place` writes to metrics.json, of one or more jobs.
//
// A figure is one or more panels, side by side:
//
//     { "title": "...", "columns": 3, "panels": [
//         { "title": "...", "x": { "label": "seconds", "log": true, "ticks": [1, 2, 4] }, "y": { "label": "error", "zero": false },
//           "series": [ { "name": "...", "points": [[1, 0.5], [2, 0.3]], "line": false, "labels": ["a", "b"] } ] } ] }
//
// Points are joined in the order given unless "line" is false; "labels" are written beside points. Series of one name look the same in all panels, so
// that one legend serves them. A table is one panel: its first column is x, every other column with a number is a series named by the header.
// Same input, same bytes.
import { readFileSync, realpathSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { parseArgs } from "node:util";
import { compile } from "vega-lite";
import { parse, View } from "vega";

const kWidth = 300, kHeight = 230;
const kColours = ["#1b6ca8", "#d1495b", "#2e8b57", "#8d5fbf", "#c98a00", "#555555", "#00808a", "#a0522d"];
const kShapes = ["circle", "square", "triangle-up", "diamond", "cross", "triangle-down", "triangle-right", "triangle-left"];

/** One panel from a table: first column x, the others series. Empty fields are no points. */
export function figureOfTable(csv, { title, y, log = "" }) {
  const [header, ...rows] = csv.trim().split(/\r?\n/).map((line) => line.split(",").map((field) => field.trim()));
  const series = header.slice(1).map((name, i) => ({
    name,
    points: rows.filter((row) => row[i + 1]).map((row) => [Number(row[0]), Number(row[i + 1])]),
  }));
  return { panels: [{ title, x: { label: header[0], log: log.includes("x") }, y: { label: y ?? header[1], log: log.includes("y") }, series }] };
}

// Title and error of each.
const CURVES = {
  estimator: ["Time model", "median error, held out"], visibility: ["Visible sets", "certified missed share"], view_space: ["View space", "bound over worst view"],
  select: ["Selection, step by step", "gap to its lower bound"], bake_rounds: ["Baking and repair", "texture bytes"], bake: ["Bake", "texel side, pixels"],
};

/** A panel for each curve that any of the jobs has; a point without error is left out where the axis is logarithmic. */
export function figureOfCurves(jobs) {
  const panels = Object.entries(CURVES).map(([curve, [title, label]]) => {
    const points = Object.fromEntries(Object.entries(jobs).map(([name, metrics]) => [name, (metrics.curves?.[curve] ?? []).filter(({ seconds }) => seconds > 0)]));
    const errors = Object.values(points).flat().map(({ error }) => error).filter((error) => error > 0);
    const log = Math.max(...errors) > 20 * Math.min(...errors);
    return {
      title, x: { label: "seconds", log: true }, y: { label, log, zero: true },
      series: Object.entries(points).map(([name, all]) => [name, all.filter(({ error }) => error > 0 || !log)]).map(([name, list]) => ({ name, points: list.map(({ seconds, error }) => [seconds, error]), labels: list.map(({ step }) => step ?? "") })),
    };
  });
  return { columns: 3, panels: panels.filter(({ series }) => series.some(({ points }) => points.length > 0)) };
}

function requirePlottable(panel) {
  for (const { name, points } of panel.series)
    for (const point of points)
      [panel.x, panel.y].forEach((axis, i) => {
        if (!Number.isFinite(point[i]) || (axis.log && point[i] <= 0)) throw new Error(`${name}: ${point} cannot stand on the axis "${axis.label}"`);
      });
}

const rowsOf = (panel) =>
  panel.series.flatMap(({ name, points, labels = [], line = true }) => points.map(([x, y], order) => ({ series: name, x, y, order, line, label: labels[order] ?? "" })));

function axis({ label, log = false, zero = false, ticks }) {
  return {
    type: "quantitative",
    title: label,
    scale: log ? { type: "log", nice: false, padding: 12 } : { zero, nice: false, padding: 12 },  // a label at the very edge would push the title up
    axis: ticks ? { values: ticks, labelExpr: "format(datum.value, '~r')" } : { tickCount: 5 },
  };
}

function panelSpec(panel, names) {
  requirePlottable(panel);
  const range = (values) => names.map((_, i) => values[i % values.length]);
  const legend = names.length > 1 ? { title: null, orient: "bottom", columns: 4, symbolSize: 60 } : null;
  const colour = { field: "series", type: "nominal", scale: { domain: names, range: range(kColours) }, legend };
  const shape = { field: "series", type: "nominal", scale: { domain: names, range: range(kShapes) }, legend };
  return {
    title: panel.title,
    width: kWidth,
    height: kHeight,
    data: { values: rowsOf(panel) },
    encoding: { x: { field: "x", ...axis(panel.x) }, y: { field: "y", ...axis(panel.y) }, color: colour },
    layer: [
      { transform: [{ filter: "datum.line" }], mark: { type: "line", strokeWidth: 1.5 }, encoding: { order: { field: "order", type: "quantitative" } } },
      { mark: { type: "point", filled: true, size: 45, opacity: 1 }, encoding: { shape } },
      { transform: [{ filter: "datum.label" }], mark: { type: "text", dx: 7, dy: -7, align: "left", fontSize: 10 }, encoding: { text: { field: "label" } } },
    ],
  };
}

export function vegaLiteSpec(figure) {
  const names = [...new Set(figure.panels.flatMap((panel) => panel.series.map(({ name }) => name)))];
  return {
    $schema: "https://vega.github.io/schema/vega-lite/v6.json",
    title: figure.title ? { text: figure.title, anchor: "middle", fontSize: 14, offset: 18 } : undefined,
    background: "white",
    padding: 12,
    columns: figure.columns ?? 3,
    spacing: { row: 84, column: 80 },
    bounds: "flush",  // else a legend wider than a panel pushes the columns apart
    concat: figure.panels.map((panel) => panelSpec(panel, names)),
    config: {
      aria: false,  // half of the file; the page describes the figure
      font: "sans-serif",
      axis: { labelFontSize: 11, titleFontSize: 12, titleFontWeight: "normal", gridColor: "#e4e4e4", titlePadding: 8 },
      legend: { labelFontSize: 11 },
      title: { fontSize: 12, fontWeight: "bold", offset: 10 },
      view: { stroke: "#bbbbbb" },
    },
  };
}

/** SVG text. */
export async function draw(figure) {
  return `${await new View(parse(compile(vegaLiteSpec(figure)).spec), { renderer: "none" }).toSVG()}\n`;
}

async function drawCurves(words) {
  const jobs = words.slice(0, -1).map((word) => word.split("="));
  if (jobs.length === 0 || jobs.some((job) => job.length !== 2) || !words.at(-1).endsWith(".svg")) throw new Error("usage: draw.mjs --curves NAME=METRICS.json.. FIGURE.svg");
  writeFileSync(words.at(-1), await draw(figureOfCurves(Object.fromEntries(jobs.map(([name, file]) => [name, JSON.parse(readFileSync(file, "utf8"))])))));
}

async function main() {
  const options = { title: { type: "string" }, y: { type: "string" }, log: { type: "string" }, curves: { type: "boolean" } };
  const { values, positionals } = parseArgs({ options, allowPositionals: true });
  if (values.curves) return drawCurves(positionals);
  const [input, output = input?.replace(/\.json$/, ".svg")] = positionals;
  if (!input || output === input) throw new Error("usage: draw.mjs FIGURE.json [FIGURE.svg] | draw.mjs TABLE.csv FIGURE.svg | draw.mjs --curves NAME=METRICS.json.. FIGURE.svg");
  const text = readFileSync(input, "utf8");
  writeFileSync(output, await draw(input.endsWith(".csv") ? figureOfTable(text, values) : JSON.parse(text)));
}

if (process.argv[1] && import.meta.url === pathToFileURL(realpathSync(process.argv[1])).href) await main();
