// The view space from above over the plan of the scene, before and with impostors, in the report's colour scale. Pointing at a cell (or moving
// there by arrow keys) names its time, its slowest direction and what takes that time; a click or Enter walks there. The plan, the directions
// and the walk come with the placement, which may be large: the times are shown before it.

import { element, folded, section, table } from "../elements";
import { walkAddress } from "../router";
import type { Placement } from "../runtime/placement";
import { isNumber, milliseconds, significant } from "../text";
import { causeText } from "./cause";
import { heatLegend, type HeatScale } from "./heat_scale";
import type { HeatCell, Metrics } from "./metrics";
import { Plate } from "./plate";
import { Regions } from "./regions";

const STEPS: Record<string, readonly [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const TABLE_ROWS = 20;

const sentence = (text: string) => `${text.slice(0, 1).toUpperCase()}${text.slice(1)}.`;
const centreOf = (cell: HeatCell): [number, number] => [(cell.x0 + cell.x1) / 2, (cell.z0 + cell.z1) / 2];

/// `walkId` null: nothing to walk through.
export function heatMap(metrics: Metrics, placement: Promise<Placement | null>, walkId: string | null): HTMLElement | null {
  const cells = (metrics.heat_map ?? []).filter((cell) => isNumber(cell.before_ms));
  if (cells.length === 0) return null;
  const map = new HeatMap(metrics, cells, walkId);
  placement.then(
    (found) => map.take(found),
    (error: unknown) => map.say(`The plan of the scene cannot be shown: ${error instanceof Error ? error.message : String(error)}`),
  );
  return map.element;
}

function scaleOf({ budget_ms }: Metrics, cells: readonly HeatCell[]): HeatScale {
  if (isNumber(budget_ms) && budget_ms > 0) return { middle_ms: budget_ms, isBudget: true };
  return { middle_ms: Math.max(...cells.map((cell) => cell.before_ms)) / 2 || 1, isBudget: false };
}

class HeatMap {
  private readonly plates: Plate[];
  private readonly status = element("p", { class: "soft", role: "status" }, "The plan of the scene is loading.");
  private readonly readout = element("div", { class: "readout", "aria-live": "polite" }, element("p", {}, "Point at a cell to read it."));
  private readonly numbers = element("div");
  private regions: Regions | null = null;
  private current: HeatCell | null = null;
  readonly element: HTMLElement;

  constructor(
    metrics: Metrics,
    private readonly cells: readonly HeatCell[],
    private readonly walkId: string | null,
  ) {
    const scale = scaleOf(metrics, cells);
    const compared = cells.some((cell) => isNumber(cell.after_ms));
    this.plates = compared
      ? [new Plate(cells, "before_ms", "Before", scale), new Plate(cells, "after_ms", "With impostors", scale)]
      : [new Plate(cells, "before_ms", "As it is", scale)];
    for (const plate of this.plates) this.listen(plate);
    this.numbers.append(this.slowest());
    const within = scale.isBudget ? "the budget" : "half of the slowest time, since the job has no budget";
    const walks = walkId === null ? "" : "; a click or Enter walks there";
    this.element = section(
      "map",
      "Where it is slow",
      `The view space from above, x to the right and z downwards. A cell's colour is the time bound of its slowest view direction; blue is within ${within}. Point at a cell, or tab to a picture and move by arrow keys, to read it${walks}.`,
      element("div", { class: "side" }, ...this.plates.map(({ figure }) => figure)),
      heatLegend(scale),
      this.status,
      this.readout,
      this.numbers,
    );
  }

  /// What the placement adds; null: there is none.
  take(placement: Placement | null): void {
    this.status.remove();
    if (placement === null) return;
    this.regions = new Regions(placement);
    for (const plate of this.plates) plate.drawPlan(placement);
    this.numbers.replaceChildren(this.slowest());
    if (this.current !== null) this.point(this.current);
  }

  say(text: string): void {
    this.status.textContent = text;
  }

  private listen(plate: Plate): void {
    let wasCurrent = true;
    plate.svg.addEventListener("pointerdown", (event) => (wasCurrent = this.at(plate, event) === this.current));
    plate.svg.addEventListener("pointermove", (event) => this.pointAt(plate, event));
    plate.svg.addEventListener("click", (event) => {
      if (this.at(plate, event) === null) return; // beside the cells, though one was pointed at before
      this.pointAt(plate, event);
      // A finger reads a cell by its first touch.
      if ((event as PointerEvent).pointerType !== "touch" || wasCurrent) this.walk();
    });
    plate.svg.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      if (event.key === "Enter") this.walk();
      if (step === undefined) return;
      event.preventDefault();
      this.point(this.current === null ? this.bySlowness()[0]! : this.neighbour(this.current, step));
    });
  }

  private pointAt(plate: Plate, event: MouseEvent): void {
    const cell = this.at(plate, event);
    if (cell !== null && cell !== this.current) this.point(cell);
  }

  /// The slowest cell there.
  private at(plate: Plate, event: MouseEvent): HeatCell | null {
    const { x, z } = plate.place(event);
    return this.cells
      .filter((cell) => cell.x0 <= x && x <= cell.x1 && cell.z0 <= z && z <= cell.z1)
      .reduce<HeatCell | null>((best, cell) => (best === null || cell.before_ms > best.before_ms ? cell : best), null);
  }

  /// The nearest cell that lies more in the direction of the step than aside of it.
  private neighbour(from: HeatCell, [dx, dz]: readonly [number, number]): HeatCell {
    const [x, z] = centreOf(from);
    let best = from,
      least = Infinity;
    for (const cell of this.cells) {
      const [cx, cz] = centreOf(cell);
      const along = (cx - x) * dx + (cz - z) * dz,
        aside = Math.abs((cx - x) * dz + (cz - z) * dx);
      if (along > 0 && along >= aside && along + 2 * aside < least) [best, least] = [cell, along + 2 * aside];
    }
    return best;
  }

  private point(cell: HeatCell): void {
    this.current = cell;
    for (const plate of this.plates) plate.mark(cell);
    this.readout.replaceChildren(...this.describe(cell));
  }

  /// Where and how slow; in which direction; why.
  private describe(cell: HeatCell): HTMLElement[] {
    const times = isNumber(cell.after_ms)
      ? `${milliseconds(cell.before_ms)} before, ${milliseconds(cell.after_ms)} with impostors`
      : milliseconds(cell.before_ms);
    const [x, z] = centreOf(cell).map((value) => significant(value, 4));
    const lines = [this.regions?.at(cell)?.text ?? "", causeText(cell.cause)].filter((line) => line !== "");
    const link = this.link(cell);
    return [
      element(
        "p",
        {},
        element("strong", {}, times),
        ` at x ${x} m, z ${z} m `,
        link !== null && element("a", { href: link }, "Walk there"),
      ),
      ...lines.map((line) => element("p", {}, sentence(line))),
    ];
  }

  private link(cell: HeatCell): string | null {
    const region = this.regions?.at(cell);
    if (this.walkId === null || region === undefined) return null;
    const [x, z] = centreOf(cell);
    return walkAddress(this.walkId, [x, region.y, z], region.direction);
  }

  private walk(): void {
    const link = this.current === null ? null : this.link(this.current);
    if (link !== null) location.hash = link;
  }

  private bySlowness(): HeatCell[] {
    return [...this.cells].sort((a, b) => b.before_ms - a.before_ms);
  }

  private slowest(): HTMLElement {
    const { regions } = this;
    const range = (low: number, high: number) => `${significant(low, 4)} \u2026 ${significant(high, 4)}`;
    const way = (cell: HeatCell) =>
      element(
        "a",
        { href: this.link(cell), "aria-label": `walk there: x ${significant(cell.x0, 4)}, z ${significant(cell.z0, 4)}` },
        "walk there",
      );
    const after = { title: "with impostors", number: true, cell: (cell: HeatCell) => milliseconds(cell.after_ms) };
    const columns = [
      { title: "x from\u2026to, m", cell: (cell: HeatCell) => range(cell.x0, cell.x1) },
      { title: "z from\u2026to, m", cell: (cell: HeatCell) => range(cell.z0, cell.z1) },
      { title: "before", number: true, cell: (cell: HeatCell) => milliseconds(cell.before_ms) },
      ...(this.plates.length > 1 ? [after] : []),
      ...(regions === null ? [] : [{ title: "slowest direction", cell: (cell: HeatCell) => regions.at(cell)?.text ?? "" }]),
      ...(this.cells.some(({ cause }) => cause) ? [{ title: "why", cell: (cell: HeatCell) => causeText(cell.cause) }] : []),
      ...(this.walkId === null || regions === null ? [] : [{ title: "", cell: way }]),
    ];
    const rows = this.bySlowness().slice(0, TABLE_ROWS);
    return folded("The slowest cells as a table", table(columns, rows, "Slowest cells of the view space"));
  }
}
