// One picture of the heat map: the cells of the view space from above, x to the right and z downwards, and a marker for the one that is read.

import { drawing, element } from "../elements";
import type { Placement } from "../runtime/placement";
import { count, isNumber, milliseconds } from "../text";
import { HEAT_CLASSES, heatClass, type HeatScale } from "./heat_scale";
import type { HeatCell } from "./metrics";

const GROUND_M = 0.5; // lower objects are no landmarks

export type TimeKey = "before_ms" | "after_ms";

/// Outlines of what stands in the scene.
function planOutline(placement: Placement): string {
  return placement.scene.objects
    .filter(({ bounds: { min, max } }) => max[1] - min[1] > GROUND_M)
    .map(({ bounds: { min, max } }) => `M${min[0]} ${min[2]}H${max[0]}V${max[2]}H${min[0]}Z`)
    .join("");
}

function viewBox(cells: readonly HeatCell[]): string {
  const x0 = Math.min(...cells.map((cell) => cell.x0)),
    z0 = Math.min(...cells.map((cell) => cell.z0));
  const width = Math.max(...cells.map((cell) => cell.x1)) - x0,
    depth = Math.max(...cells.map((cell) => cell.z1)) - z0,
    margin = 0.02 * Math.max(width, depth);
  return [x0 - margin, z0 - margin, width + 2 * margin, depth + 2 * margin].join(" ");
}

/// Per class, the outlines of its cells. The slowest come last, so that none is covered by a fast one above or below it.
function cellPaths(cells: readonly HeatCell[], key: TimeKey, scale: HeatScale): SVGPathElement[] {
  const outlines = new Map<string, string>();
  for (const cell of cells) {
    const shade = heatClass(cell[key], scale);
    outlines.set(shade, `${outlines.get(shade) ?? ""}M${cell.x0} ${cell.z0}H${cell.x1}V${cell.z1}H${cell.x0}Z`);
  }
  return HEAT_CLASSES.filter((shade) => outlines.has(shade)).map((shade) =>
    drawing("path", { d: outlines.get(shade), class: `heat-${shade}` }),
  );
}

export class Plate {
  readonly svg: SVGSVGElement;
  readonly figure: HTMLElement;
  // Dark around light: one of the two is seen on any colour.
  private readonly marker = drawing(
    "g",
    { visibility: "hidden" },
    drawing("rect", { class: "halo" }),
    drawing("rect", { class: "marker" }),
  );

  constructor(cells: readonly HeatCell[], key: TimeKey, name: string, scale: HeatScale) {
    const slow = cells.filter((cell) => isNumber(cell[key]) && cell[key] > scale.middle_ms).length;
    const over = `${count(slow)} of ${count(cells.length)} cells over ${milliseconds(scale.middle_ms)}`;
    this.svg = drawing(
      "svg",
      { class: "plate", viewBox: viewBox(cells), role: "application", tabindex: 0, "aria-label": `Plan view, ${name}: ${over}` },
      ...cellPaths(cells, key, scale),
      this.marker,
    );
    this.figure = element("figure", {}, this.svg, element("figcaption", {}, element("strong", {}, name), ` \u2014 ${over}`));
  }

  drawPlan(placement: Placement): void {
    this.marker.before(drawing("path", { d: planOutline(placement), class: "objects" }));
  }

  mark({ x0, z0, x1, z1 }: HeatCell): void {
    this.marker.setAttribute("visibility", "visible");
    for (const rect of this.marker.children)
      for (const [name, value] of Object.entries({ x: x0, y: z0, width: x1 - x0, height: z1 - z0 })) rect.setAttribute(name, String(value));
  }

  /// Of an event, in metres.
  place({ clientX, clientY }: MouseEvent): { x: number; z: number } {
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(this.svg.getScreenCTM()!.inverse());
    return { x, z: y };
  }
}
