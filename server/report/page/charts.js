// Line charts, drawn by uPlot in the page's own colours, and redrawn when those or the width change.

const charts = [];

function cssColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function axis(label, format, logarithmic) {
  const shared = { stroke: cssColour("--ink"), grid: { stroke: cssColour("--line"), width: 1 }, ticks: { stroke: cssColour("--line"), width: 1 } };
  const values = (chart, splits) => splits.map((value) => (value === null ? "" : format(value)));
  return { ...shared, label, labelSize: 22, labelFont: "14px system-ui", font: "13px system-ui", size: label.length > 0 ? 66 : 50, values: logarithmic ? (chart, splits) => values(chart, decades(splits)) : values };
}

/// Labels only at powers of ten (and, on less than two decades, at 2 and 5 times those): others would overlap.
function decades(splits) {
  const shown = splits.filter((value) => value !== null);
  const wide = shown.length > 0 && shown[shown.length - 1] / shown[0] > 200;
  return splits.map((value) => {
    if (value === null) return null;
    const lead = Math.round(value / Math.pow(10, Math.floor(Math.log10(value) + 1e-9)));
    return lead === 1 || (!wide && (lead === 2 || lead === 5)) ? value : null;
  });
}

/// options: {label (for screen readers), x: {label, format, log}, y: {...}, series: [{name, colour (css variable), dash, points, values}], xs, height}
function lineChart(options) {
  const host = element("div", { class: "chart", role: "img", "aria-label": options.label });
  charts.push({ host, options, plot: null });
  return host;
}

function plotSeries(series, formatY) {
  const stroke = cssColour(series.colour);
  return {
    label: series.name, stroke, width: 2, dash: series.dash, spanGaps: true, points: { show: Boolean(series.points), size: 7, stroke, fill: stroke },
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
