// Elements and numbers as text. Everything that comes from a file reaches the page through textContent or an attribute, never as markup.

function element(tag, attributes, ...children) {
  const node = document.createElementNS(SVG_TAGS.has(tag) ? "http://www.w3.org/2000/svg" : "http://www.w3.org/1999/xhtml", tag);
  for (const [name, value] of Object.entries(attributes || {})) if (value !== undefined && value !== null) node.setAttribute(name, value);
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}
const SVG_TAGS = new Set(["svg", "path", "rect", "line", "text", "g"]);

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const NONE = "\u2013";

function significant(value, digits) {
  if (!isNumber(value)) return NONE;
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e9)) return value.toExponential(digits - 1).replace(/\.?0*e/, "e");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value) || 1)));
  return value.toLocaleString("en", { maximumFractionDigits: Math.min(decimals, 6) });
}

/// For an axis, beside which seven digits have no room: 3.05M.
const compact = (value) => (Math.abs(value) < 1e4 ? significant(value, 3) : value.toLocaleString("en", { notation: "compact", maximumSignificantDigits: 5 }));
const milliseconds = (value) => (isNumber(value) ? `${significant(value, 3)} ms` : NONE);
const seconds = (value) => (isNumber(value) ? `${significant(value, 3)} s` : NONE);
const count = (value) => (isNumber(value) ? Math.round(value).toLocaleString("en") : NONE);
const percent = (value) => (isNumber(value) ? `${significant(100 * value, 3)} %` : NONE);

function bytes(value) {
  if (!isNumber(value)) return NONE;
  const units = ["B", "kB", "MB", "GB"];
  let scaled = value, unit = 0;
  while (scaled >= 1000 && unit < units.length - 1) { scaled /= 1000; ++unit; }
  return `${significant(scaled, 3)} ${units[unit]}`;
}

/// path("a.b.c") of a nested object, undefined where a part is missing.
function field(object, path) {
  return path.split(".").reduce((value, key) => (value === null || value === undefined ? undefined : value[key]), object);
}

/// columns: [{title, text(row), number: bool}]
function table(columns, rows, caption) {
  const kind = (column) => (column.number ? "number" : "text");
  const head = element("tr", {}, ...columns.map((column) => element("th", { scope: "col", class: kind(column) }, column.title)));
  const body = rows.map((row) => element("tr", {}, ...columns.map((column) => element("td", { class: kind(column) }, column.text(row)))));
  const inner = element("table", { "aria-label": caption }, element("thead", {}, head), element("tbody", {}, ...body));
  return element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": caption }, inner);
}

function folded(title, ...children) {
  return element("details", {}, element("summary", {}, title), ...children);
}
