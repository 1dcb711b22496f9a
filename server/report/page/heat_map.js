// The view space in plan view, one picture before and one after, in one colour scale whose middle is the budget.

const HEAT_LIMITS = [0.25, 0.5, 0.75, 1, 1.25, 1.5, 2, 3, Infinity];  // upper ends of the classes, in budgets; up to 1 is within budget

/// {middle_ms, name}: the budget, or (a survey may have none) half of the slowest time.
function heatScale(metrics, cells) {
  if (isNumber(metrics.budget_ms)) return { middle_ms: metrics.budget_ms, name: "budget" };
  return { middle_ms: cells.reduce((most, cell) => Math.max(most, cell.before_ms), 0) / 2 || 1, name: "half of the slowest" };
}

function heatClass(time_ms, middle_ms) {
  if (!isNumber(time_ms)) return "none";
  return HEAT_LIMITS.findIndex((limit) => time_ms <= limit * middle_ms);
}

function heatLegend({ middle_ms, name }) {
  const entries = HEAT_LIMITS.map((limit, index) => {
    const low = index === 0 ? 0 : HEAT_LIMITS[index - 1] * middle_ms;
    const range = limit === Infinity ? `over ${milliseconds(low)}` : `${significant(low, 3)} to ${milliseconds(limit * middle_ms)}`;
    return element("li", {}, element("span", { class: "swatch", style: `background: var(--heat-${index})` }), limit === 1 ? `${range} (${name})` : range);
  });
  return element("ul", { class: "legend", "aria-label": "Colours of the heat map" }, ...entries);
}

function planBounds(cells) {
  const least = (key) => cells.reduce((value, cell) => Math.min(value, cell[key]), Infinity);
  const most = (key) => cells.reduce((value, cell) => Math.max(value, cell[key]), -Infinity);
  return { x0: least("x0"), z0: least("z0"), x1: most("x1"), z1: most("z1") };
}

/// One path per colour class, cells drawn slowest last, so that a slow one is not covered by a fast one above or below it.
function heatPlate(cells, bounds, key, middle_ms, title) {
  const outlines = new Map();
  for (const cell of cells) {
    const shade = heatClass(cell[key], middle_ms);
    const outline = `M${cell.x0} ${cell.z0}H${cell.x1}V${cell.z1}H${cell.x0}Z`;
    outlines.set(shade, (outlines.get(shade) || "") + outline);
  }
  const order = ["none", ...HEAT_LIMITS.keys()].filter((shade) => outlines.has(shade));
  const paths = order.map((shade) => element("path", { d: outlines.get(shade), style: `fill: var(--heat-${shade})` }));
  const marker = element("rect", { class: "marker", width: 0, height: 0, visibility: "hidden" });
  const width = bounds.x1 - bounds.x0, depth = bounds.z1 - bounds.z0, margin = 0.02 * Math.max(width, depth);
  const viewBox = [bounds.x0 - margin, bounds.z0 - margin, width + 2 * margin, depth + 2 * margin].join(" ");
  const plate = element("svg", { class: "plate", viewBox, role: "img", "aria-label": title, preserveAspectRatio: "xMidYMid meet" }, ...paths, marker);
  return { plate, marker };
}

function describeCell(cell) {
  const centre = `x ${significant((cell.x0 + cell.x1) / 2, 4)} m, z ${significant((cell.z0 + cell.z1) / 2, 4)} m`;
  return isNumber(cell.after_ms) ? `${centre}: ${milliseconds(cell.before_ms)} before, ${milliseconds(cell.after_ms)} after` : `${centre}: ${milliseconds(cell.before_ms)}`;
}

function pointOn(plate, event) {
  return new DOMPoint(event.clientX, event.clientY).matrixTransform(plate.getScreenCTM().inverse());
}

/// The slowest cell under the pointer, outlined in every picture and named below.
function followPointer(plates, cells, readout) {
  const show = (cell) => {
    for (const { marker } of plates) {
      marker.setAttribute("visibility", cell ? "visible" : "hidden");
      if (cell) for (const [name, value] of Object.entries({ x: cell.x0, y: cell.z0, width: cell.x1 - cell.x0, height: cell.z1 - cell.z0 })) marker.setAttribute(name, value);
    }
    readout.textContent = cell ? describeCell(cell) : "Point at a cell to read its times.";
  };
  const slower = (best, cell) => (best === null || cell.before_ms > best.before_ms ? cell : best);
  for (const { plate } of plates) {
    plate.addEventListener("pointermove", (event) => {
      const point = pointOn(plate, event);
      const under = cells.filter((cell) => cell.x0 <= point.x && point.x <= cell.x1 && cell.z0 <= point.y && point.y <= cell.z1);
      show(under.reduce(slower, null));
    });
    plate.addEventListener("pointerleave", () => show(null));
  }
  show(null);
}

function slowestCells(cells) {
  const rows = [...cells].sort((a, b) => b.before_ms - a.before_ms).slice(0, 20);
  const columns = [
    { title: "x from\u2026to, m", text: (cell) => `${significant(cell.x0, 4)} \u2026 ${significant(cell.x1, 4)}` },
    { title: "z from\u2026to, m", text: (cell) => `${significant(cell.z0, 4)} \u2026 ${significant(cell.z1, 4)}` },
    { title: "before", number: true, text: (cell) => milliseconds(cell.before_ms) },
    { title: "after", number: true, text: (cell) => milliseconds(cell.after_ms) },
  ];
  return folded("The slowest cells as a table", table(columns, rows, "Slowest cells of the view space"));
}

function heatMapFigure(cells, scale) {
  const bounds = planBounds(cells);
  const hasAfter = cells.some((cell) => isNumber(cell.after_ms));
  const over = (key) => count(cells.filter((cell) => cell[key] > scale.middle_ms).length);
  const picture = (key, name) => {
    const drawn = heatPlate(cells, bounds, key, scale.middle_ms, `Plan view ${name}: ${over(key)} of ${count(cells.length)} cells over ${milliseconds(scale.middle_ms)}`);
    const caption = element("figcaption", {}, element("strong", {}, name), ` \u2014 ${over(key)} of ${count(cells.length)} cells over ${milliseconds(scale.middle_ms)}`);
    return { ...drawn, figure: element("figure", {}, drawn.plate, caption) };
  };
  const plates = hasAfter ? [picture("before_ms", "Before"), picture("after_ms", "With impostors")] : [picture("before_ms", "As it is")];
  const readout = element("p", { class: "readout soft" });
  followPointer(plates, cells, readout);
  return [element("div", { class: "side" }, ...plates.map((plate) => plate.figure)), heatLegend(scale), readout, slowestCells(cells)];
}
