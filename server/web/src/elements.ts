// Elements of the page. What comes from a file or the server reaches it through textContent or an attribute, never as markup.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | null | undefined>;
const SVG_TAGS = new Set(["svg", "path", "rect", "g"]);

function make(namespace: string, tag: string, attributes: Attributes, children: Child[]): Element {
  const node = document.createElementNS(namespace, tag);
  for (const [name, value] of Object.entries(attributes))
    if (value !== undefined && value !== null && value !== false) node.setAttribute(name, value === true ? "" : String(value));
  node.append(...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false));
  return node;
}

export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  return make("http://www.w3.org/1999/xhtml", tag, attributes, children) as HTMLElementTagNameMap[Tag];
}

export function drawing<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[Tag] {
  if (!SVG_TAGS.has(tag)) throw new Error(`<${tag}> is no drawing element of this page`);
  return make("http://www.w3.org/2000/svg", tag, attributes, children) as SVGElementTagNameMap[Tag];
}

export function section(id: string, title: string, lead: string, ...children: Child[]): HTMLElement {
  return element(
    "section",
    { id, "aria-labelledby": `${id}-title` },
    element("h2", { id: `${id}-title` }, title),
    lead !== "" && element("p", { class: "soft" }, lead),
    ...children,
  );
}

export interface Column<Row> {
  readonly title: string;
  readonly number?: boolean;
  readonly cell: (row: Row) => Child;
}

export function table<Row>(columns: readonly Column<Row>[], rows: readonly Row[], caption: string): HTMLElement {
  const kind = (column: Column<Row>) => (column.number === true ? "number" : "text");
  const head = element("tr", {}, ...columns.map((column) => element("th", { scope: "col", class: kind(column) }, column.title)));
  const body = rows.map((row) => element("tr", {}, ...columns.map((column) => element("td", { class: kind(column) }, column.cell(row)))));
  const inner = element("table", { "aria-label": caption }, element("thead", {}, head), element("tbody", {}, ...body));
  return element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": caption }, inner);
}

/// Names and what they have, one below the other.
export const factList = (entries: readonly (readonly [string, Child])[]): HTMLElement =>
  element("dl", { class: "facts" }, ...entries.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));

export const folded = (title: string, ...children: Child[]) => element("details", {}, element("summary", {}, title), ...children);

export function button(text: string, action: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const node = element("button", { type: "button", ...attributes }, text);
  node.addEventListener("click", action);
  return node;
}

/// Puts children in place of what a node holds, unless they look the same: what is focused or selected stays so.
export function replaceIfChanged(host: Element, ...children: Node[]): void {
  const next = host.cloneNode(false) as Element;
  next.append(...children);
  if (next.innerHTML !== host.innerHTML) host.replaceChildren(...next.childNodes);
}
