// Line charts, drawn by uPlot in the page's own colours, and redrawn when those or the width change.

const charts = [];

function cssColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function axis(label, format, logarithmic) {
  const line = cssColour("--line"), ink = cssColour("--ink");
  const shown = logarithmic ? (chart, splits) => labelledSplits(splits) : (chart, splits) => splits;
  return {
    label, labelSize: 22, labelFont: "14px system-ui", font: "13px system-ui", size: 66, stroke: ink,
    grid: { stroke: line, width: 1, filter: shown }, ticks: { stroke: line, width: 1, filter: shown }, filter: shown,
    values: (chart, splits) => splits.map((value) => (value === null ? "" : format(value))),
  };
}

/// Of a logarithmic axis only powers of ten are labelled (and, on two decades or less, 2 and 5 times those): others would overlap.
function labelledSplits(splits) {
  const known = splits.filter((value) => value !== null);
  const wide = known.length > 0 && known[known.length - 1] / known[0] > 200;
  const lead = (value) => Math.round(value / Math.pow(10, Math.floor(Math.log10(value) + 1e-9)));
  return splits.map((value) => (value !== null && (lead(value) === 1 || (!wide && [2, 5].includes(lead(value)))) ? value : null));
}

/// options: {label (for screen readers), x: {label, format, log}, y: {...}, series: [{name, colour (css variable), dash, points, marksOnly, values}], xs, height}
function lineChart(options) {
  const host = element("div", { class: "chart", role: "img", "aria-label": options.label });
  charts.push({ host, options, plot: null });
  return host;
}

function plotSeries(series, formatY) {
  const stroke = cssColour(series.colour);
  return {
    label: series.name, stroke, width: 2, dash: series.dash, spanGaps: true, ...(series.marksOnly ? { paths: () => null } : {}), points: { show: Boolean(series.points), size: 7, stroke, fill: stroke },
    value: (chart, value) => (value === null || value === undefined ? NONE : formatY(value)),
  };
}

function drawChart(chart) {
  const { host, options } = chart;
  if (chart.plot !== null) chart.plot.destroy();
  const { x, y } = options;
  const scale = (dimension) => (dimension.log ? { time: false, distr: 3 } : { time: false, range: dimension.range });
  const horizontal = axis(x.label, x.format, x.log);
  horizontal.size = 40;
  const settings = {
    width: Math.max(240, Math.floor(host.clientWidth)), height: options.height || 300,
    scales: { x: scale(x), y: scale(y) },
    axes: [horizontal, axis(y.label, y.format, y.log)],
    series: [{ label: x.label, value: (plot, value) => (value === null ? NONE : x.format(value)) }, ...options.series.map((series) => plotSeries(series, y.format))],
    cursor: { drag: { x: false, y: false } },
    legend: { show: options.series.length > 1, markers: { width: 3, fill: "transparent", dash: (plot, index) => (index > 0 && options.series[index - 1].dash ? "dotted" : "solid") } },
  };
  chart.plot = new uPlot(settings, [options.xs, ...options.series.map((series) => series.values)], host);
}

function drawAllCharts() {
  for (const chart of charts) drawChart(chart);
}

function keepChartsFresh() {
  drawAllCharts();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAllCharts);
  let timer = 0;
  addEventListener("resize", () => { clearTimeout(timer); timer = setTimeout(drawAllCharts, 150); });
}
