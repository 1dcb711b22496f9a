// The heat map's colour scale: classes of time around a middle, which is the budget where there is one. Blue up to it, hot above.

import { element } from "../elements";
import { isNumber, milliseconds, significant } from "../text";

const LIMITS = [0.25, 0.5, 0.75, 1, 1.25, 1.5, 2, 3, Infinity]; // upper ends of the classes, in middles

export interface HeatScale {
  readonly middle_ms: number;
  readonly isBudget: boolean; // or half of the slowest time
}

/// Classes, coldest first, as the style sheet names them; "none" has no time.
export const HEAT_CLASSES = ["none", ...LIMITS.keys()].map(String);
export const heatClass = (time: number | null | undefined, { middle_ms }: HeatScale) =>
  isNumber(time) ? String(LIMITS.findIndex((limit) => time <= limit * middle_ms)) : "none";

export function heatLegend({ middle_ms, isBudget }: HeatScale): HTMLElement {
  const items = LIMITS.map((limit, index) => {
    const low = index === 0 ? 0 : LIMITS[index - 1]! * middle_ms;
    const range = limit === Infinity ? `over ${milliseconds(low)}` : `${significant(low, 3)} to ${milliseconds(limit * middle_ms)}`;
    const name = isBudget ? "budget" : "half of the slowest";
    return element("li", {}, element("span", { class: `swatch heat-${index}` }), limit === 1 ? `${range} (${name})` : range);
  });
  return element("ul", { class: "legend", "aria-label": "Colours of the heat map" }, ...items);
}
