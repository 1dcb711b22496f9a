// What a running job has in hand, in words: what would be the result if it ended now.

import type { Job } from "./api";
import { element, factList } from "./elements";
import { bytes, count, isNumber, milliseconds, percent, significant } from "./text";

type Figures = NonNullable<Job["best_so_far"]>;
interface Figure {
  readonly name: string;
  readonly text: (value: unknown) => string;
}

const KNOWN: Record<string, Figure> = {
  points: { name: "budgets done", text: count },
  unsolved_points: { name: "of these, with regions not solved", text: count },
  texture_bytes: { name: "textures", text: bytes },
  impostors: { name: "impostors", text: count },
  unsolved_cpvs: { name: "slow regions not solved", text: count },
  worst_bound_ms: { name: "slowest view without impostors", text: milliseconds },
  median_error: { name: "median error of the time model", text: percent },
  frames: { name: "frames timed", text: count },
};

const UNITS: readonly (readonly [string, Figure["text"]])[] = [
  ["_bytes", bytes],
  ["_ms", milliseconds],
];
const plain = (value: unknown) => (isNumber(value) ? significant(value, 4) : JSON.stringify(value));

/// A figure that this page does not know is named as the server names it.
function figureOf(key: string): Figure {
  const [suffix = "", text = plain] = UNITS.find(([unit]) => key.endsWith(unit)) ?? [];
  return KNOWN[key] ?? { name: key.slice(0, key.length - suffix.length).replaceAll("_", " "), text };
}

const rank = (key: string) => (key in KNOWN ? Object.keys(KNOWN).indexOf(key) : Infinity);

/// Name and text of each figure, the known ones first.
export const bestEntries = (figures: Figures): [string, string][] =>
  Object.keys(figures)
    .sort((a, b) => rank(a) - rank(b) || a.localeCompare(b))
    .map((key) => {
      const { name, text } = figureOf(key);
      return [name, text(figures[key])];
    });

export function bestSoFar(figures: Figures): HTMLElement {
  return element("div", { class: "best" }, element("h2", {}, "Best so far"), factList(bestEntries(figures)));
}
