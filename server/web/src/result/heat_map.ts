// The view space from above over the plan of the scene, before and with impostors, in the report's colour scale. Pointing at a cell (or moving
// there by arrow keys) names its time and its slowest direction; a click or Enter walks there.

import { drawing, element, folded, section, table } from "../elements";
import { walkAddress } from "../router";
import type { Placement } from "../runtime/placement";
import { count, isNumber, milliseconds, significant } from "../text";
import type { HeatCell, Metrics, Triple } from "./metrics";

const LIMITS = [0.25, 0.5, 0.75, 1, 1.25, 1.5, 2, 3, Infinity]; // upper ends of the classes, in budgets; up to 1 is within it
const GROUND_M = 0.5; // lower objects are no landmarks

type TimeKey = "before_ms" | "after_ms";
interface Plate {
  readonly svg: SVGSVGElement;
  readonly marker: SVGRectElement;
}
export interface HeatOptions {
  readonly metrics: Metrics;
  readonly placement: Placement | null;
  readonly walkId: string | null;
} // null: nothing to walk through

const classOf = (time: number | null | undefined, middle: number) =>
  isNumber(time) ? String(LIMITS.findIndex((limit) => time <= limit * middle)) : "none";

function legend(middle: number, name: string): HTMLElement {
  return element(
    "ul",
    { class: "legend", "aria-label": "Colours of the heat map" },
    ...LIMITS.map((limit, index) => {
      const low = index === 0 ? 0 : LIMITS[index - 1]! * middle;
      const range = limit === Infinity ? `over ${milliseconds(low)}` : `${significant(low, 3)} to ${milliseconds(limit * middle)}`;
      return element("li", {}, element("span", { class: `swatch heat-${index}` }), limit === 1 ? `${range} (${name})` : range);
    }),
  );
}

/// Outlines of what stands in the scene.
function planOutline(placement: Placement): string {
  return placement.scene.objects
    .filter(({ bounds: { min, max } }) => max[1] - min[1] > GROUND_M)
    .map(({ bounds: { min, max } }) => `M${min[0]} ${min[2]}H${max[0]}V${max[2]}H${min[0]}Z`)
    .join("");
}

interface Region {
  readonly direction: Triple;
  readonly text: string;
  readonly y: number;
}

/// Per cell of the heat map: its slowest region's direction, and what it says.
class Regions {
  private readonly byPlace = new Map<string, Region>();

  constructor(placement: Placement) {
    const slowest = new Map<number, number>();
    placement.cpvs.forEach((cpv, id) => {
      const known = slowest.get(cpv.cell);
      if (known === undefined || placement.cpvs[known]!.bound_before_ms < cpv.bound_before_ms) slowest.set(cpv.cell, id);
    });
    const best = new Map<string, number>();
    placement.cells.forEach((cell, id) => {
      const key = keyOf({ x0: cell.min[0], z0: cell.min[2] });
      const cpv = slowest.get(id),
        time = cpv === undefined ? 0 : placement.cpvs[cpv]!.bound_before_ms;
      if (this.byPlace.has(key) && (best.get(key) ?? 0) >= time) return;
      best.set(key, time);
      this.byPlace.set(key, regionOf(placement, id, cpv));
    });
  }

  at(cell: HeatCell): Region | undefined {
    return this.byPlace.get(keyOf(cell));
  }
}

const keyOf = ({ x0, z0 }: { x0: number; z0: number }) => `${x0.toFixed(3)} ${z0.toFixed(3)}`;

function regionOf(placement: Placement, cellId: number, cpvId: number | undefined): Region {
  const cell = placement.cells[cellId]!;
  const y = (cell.min[1] + cell.max[1]) / 2;
  const seen = cell.visible_objects === null ? "all objects may be seen" : `${count(cell.visible_objects.length)} objects may be seen`;
  if (cpvId === undefined) return { direction: [0, 0, -1], text: `${seen}; no slow direction`, y };
  const cpv = placement.cpvs[cpvId]!;
  const direction = middleOf(placement, cpv.interval);
  const help =
    cpv.impostors.length === 0 ? "no impostor" : `${count(cpv.impostors.length)} ${cpv.impostors.length === 1 ? "impostor" : "impostors"}`;
  return { direction, text: `slowest looking ${compass(direction)}, where ${seen}; ${help}${cpv.solved ? "" : ", not solved"}`, y };
}

/// Middle direction of an interval: d ~ n + tan(a) u + tan(b) v on its face.
function middleOf(placement: Placement, id: number): Triple {
  const { face, level, index } = placement.intervals[id]!;
  const { n, u, v } = (placement as unknown as { faces: Record<string, { n: Triple; u: Triple; v: Triple }> }).faces[face]!;
  const [a, b] = index.map((i) => Math.tan((Math.PI / 4) * ((2 * i + 1) / 2 ** level - 1))) as [number, number];
  const direction = [0, 1, 2].map((axis) => n[axis]! + a * u[axis]! + b * v[axis]!);
  const length = Math.hypot(...direction);
  return direction.map((value) => value / length) as Triple;
}

/// "to +x, 12 degrees up": the plan has x to the right and z downwards.
function compass([x, y, z]: Triple): string {
  const turn = (Math.round(Math.atan2(z, x) / (Math.PI / 4)) + 8) % 8;
  const side = ["right", "down right", "down", "down left", "left", "up left", "up", "up right"][turn]!;
  const pitch = Math.round((Math.asin(y) * 180) / Math.PI);
  return `${side} on the plan${pitch === 0 ? "" : `, ${Math.abs(pitch)}\u00b0 ${pitch > 0 ? "above" : "below"} the horizon`}`;
}

export function heatMap(options: HeatOptions): HTMLElement | null {
  const cells = (options.metrics.heat_map ?? []).filter((cell) => isNumber(cell.before_ms));
  if (cells.length === 0) return null;
  return new HeatMap(options, cells).element;
}

class HeatMap {
  private readonly plates: Plate[];
  private readonly readout = element("p", { class: "readout", "aria-live": "polite" });
  private readonly middle: number;
  private readonly regions: Regions | null;
  private current: HeatCell | null = null;
  readonly element: HTMLElement;

  constructor(
    private readonly options: HeatOptions,
    private readonly cells: readonly HeatCell[],
  ) {
    const { metrics, placement, walkId } = options;
    const hasBudget = isNumber(metrics.budget_ms) && metrics.budget_ms > 0;
    this.middle = hasBudget ? metrics.budget_ms! : Math.max(...cells.map((cell) => cell.before_ms)) / 2 || 1;
    this.regions = placement === null ? null : new Regions(placement);
    const keys: [TimeKey, string][] = cells.some((cell) => isNumber(cell.after_ms))
      ? [
          ["before_ms", "Before"],
          ["after_ms", "With impostors"],
        ]
      : [["before_ms", "As it is"]];
    const drawn = keys.map(([key, name]) => this.plate(key, name));
    this.plates = drawn.map(({ plate }) => plate);
    this.point(null);
    const lead =
      `The view space from above, x to the right and z downwards${placement === null ? "" : ", with the outlines of what stands in the scene"}. A cell's colour is the time bound of its slowest view direction; blue is within ${hasBudget ? "the budget" : "half of the slowest time, since the job has no budget"}.` +
      (walkId === null ? "" : " Point at a cell, or tab to a picture and move by arrow keys, to read it; a click or Enter walks there.");
    this.element = section(
      "map",
      "Where it is slow",
      lead,
      element("div", { class: "side" }, ...drawn.map(({ figure }) => figure)),
      legend(this.middle, hasBudget ? "budget" : "half of the slowest"),
      this.readout,
      this.slowest(),
    );
  }

  private plate(key: TimeKey, name: string): { plate: Plate; figure: HTMLElement } {
    const outlines = new Map<string, string>();
    for (const cell of this.cells) {
      const shade = classOf(cell[key], this.middle);
      outlines.set(shade, `${outlines.get(shade) ?? ""}M${cell.x0} ${cell.z0}H${cell.x1}V${cell.z1}H${cell.x0}Z`);
    }
    // Slowest last, so that a slow cell is not covered by a fast one above or below it.
    const shades = ["none", ...LIMITS.keys()].map(String).filter((shade) => outlines.has(shade));
    const marker = drawing("rect", { class: "marker", width: 0, height: 0, visibility: "hidden" });
    const over = `${count(this.cells.filter((cell) => isNumber(cell[key]) && cell[key] > this.middle).length)} of ${count(this.cells.length)} cells over ${milliseconds(this.middle)}`;
    const { placement } = this.options;
    const svg = drawing(
      "svg",
      {
        class: "plate",
        viewBox: this.viewBox(),
        role: "application",
        tabindex: 0,
        "aria-label": `Plan view, ${name}: ${over}`,
        preserveAspectRatio: "xMidYMid meet",
      },
      ...shades.map((shade) => drawing("path", { d: outlines.get(shade), class: `heat-${shade}` })),
      placement !== null && drawing("path", { d: planOutline(placement), class: "objects" }),
      marker,
    );
    this.listen(svg);
    return {
      plate: { svg, marker },
      figure: element("figure", {}, svg, element("figcaption", {}, element("strong", {}, name), ` \u2014 ${over}`)),
    };
  }

  private viewBox(): string {
    const { cells } = this;
    const x0 = Math.min(...cells.map((cell) => cell.x0)),
      z0 = Math.min(...cells.map((cell) => cell.z0));
    const width = Math.max(...cells.map((cell) => cell.x1)) - x0,
      depth = Math.max(...cells.map((cell) => cell.z1)) - z0,
      margin = 0.02 * Math.max(width, depth);
    return [x0 - margin, z0 - margin, width + 2 * margin, depth + 2 * margin].join(" ");
  }

  private listen(svg: SVGSVGElement): void {
    svg.addEventListener("pointermove", (event) => {
      const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM()!.inverse());
      this.point(this.slowestAt(x, y));
    });
    svg.addEventListener("click", () => this.walk());
    svg.addEventListener("keydown", (event) => {
      const steps: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const step = steps[event.key];
      if (event.key === "Enter") this.walk();
      if (step === undefined) return;
      event.preventDefault();
      this.point(this.current === null ? this.bySlowness()[0]! : this.neighbour(this.current, step));
    });
  }

  private slowestAt(x: number, z: number): HeatCell | null {
    return this.cells
      .filter((cell) => cell.x0 <= x && x <= cell.x1 && cell.z0 <= z && z <= cell.z1)
      .reduce<HeatCell | null>((best, cell) => (best === null || cell.before_ms > best.before_ms ? cell : best), null);
  }

  /// The nearest cell that lies more in the direction of the step than aside of it.
  private neighbour(from: HeatCell, [dx, dz]: [number, number]): HeatCell {
    const centre = (cell: HeatCell): [number, number] => [(cell.x0 + cell.x1) / 2, (cell.z0 + cell.z1) / 2];
    const [x, z] = centre(from);
    let best = from,
      least = Infinity;
    for (const cell of this.cells) {
      const [cx, cz] = centre(cell);
      const along = (cx - x) * dx + (cz - z) * dz,
        aside = Math.abs((cx - x) * dz + (cz - z) * dx);
      if (along > 0 && along >= aside && along + 2 * aside < least) [best, least] = [cell, along + 2 * aside];
    }
    return best;
  }

  private point(cell: HeatCell | null): void {
    this.current = cell;
    for (const { marker } of this.plates) {
      marker.setAttribute("visibility", cell === null ? "hidden" : "visible");
      if (cell !== null)
        for (const [name, value] of Object.entries({ x: cell.x0, y: cell.z0, width: cell.x1 - cell.x0, height: cell.z1 - cell.z0 }))
          marker.setAttribute(name, String(value));
    }
    const link = cell === null ? null : this.link(cell);
    this.readout.replaceChildren(
      ...(cell === null
        ? ["Point at a cell to read it."]
        : [this.describe(cell), ...(link === null ? [] : [" ", element("a", { href: link }, "Walk there")])]),
    );
  }

  private describe(cell: HeatCell): string {
    const times = isNumber(cell.after_ms)
      ? `${milliseconds(cell.before_ms)} before, ${milliseconds(cell.after_ms)} with impostors`
      : milliseconds(cell.before_ms);
    const region = this.regions?.at(cell);
    return `x ${significant((cell.x0 + cell.x1) / 2, 4)} m, z ${significant((cell.z0 + cell.z1) / 2, 4)} m: ${times}${region === undefined ? "" : `; ${region.text}`}.`;
  }

  private link(cell: HeatCell): string | null {
    const region = this.regions?.at(cell);
    if (this.options.walkId === null || region === undefined) return null;
    return walkAddress(this.options.walkId, [(cell.x0 + cell.x1) / 2, region.y, (cell.z0 + cell.z1) / 2], region.direction);
  }

  private walk(): void {
    const link = this.current === null ? null : this.link(this.current);
    if (link !== null) location.hash = link;
  }

  private bySlowness(): HeatCell[] {
    return [...this.cells].sort((a, b) => b.before_ms - a.before_ms);
  }

  private slowest(): HTMLElement {
    const range = (low: number, high: number) => `${significant(low, 4)} \u2026 ${significant(high, 4)}`;
    const place = (cell: HeatCell) => {
      const link = this.link(cell);
      return link === null
        ? ""
        : element(
            "a",
            { href: link, "aria-label": `walk there: x ${significant(cell.x0, 4)}, z ${significant(cell.z0, 4)}` },
            "walk there",
          );
    };
    const columns = [
      { title: "x from\u2026to, m", cell: (cell: HeatCell) => range(cell.x0, cell.x1) },
      { title: "z from\u2026to, m", cell: (cell: HeatCell) => range(cell.z0, cell.z1) },
      { title: "before", number: true, cell: (cell: HeatCell) => milliseconds(cell.before_ms) },
      { title: "with impostors", number: true, cell: (cell: HeatCell) => milliseconds(cell.after_ms) },
      { title: "why", cell: (cell: HeatCell) => this.regions?.at(cell)?.text ?? "" },
      { title: "", cell: place },
    ];
    return folded("The slowest cells as a table", table(columns, this.bySlowness().slice(0, 20), "Slowest cells of the view space"));
  }
}
