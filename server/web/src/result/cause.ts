// Why a place is slow, in one line: what kind of work its slowest region's time goes into, and which objects take most of it.

import { milliseconds } from "../text";
import type { Cause } from "./metrics";

const LEAST_SHARE = 0.095; // what rounds to less than a tenth explains nothing

const nameOf = ({ name, object }: Cause["objects"][number]) => name || `object ${object}`;

/// "80 % triangles, 10 % pixels; most by tree_03 (12.3 ms), house_1 (4 ms)"; nothing of a cell without a cause.
export function causeText(cause: Cause | null | undefined): string {
  if (cause === null || cause === undefined) return "";
  const kinds: [string, number][] = [
    ["triangles", cause.triangles_share],
    ["pixels", cause.pixels_share],
    ["draw calls", cause.draws_share],
  ];
  const work = kinds
    .filter(([, share]) => share >= LEAST_SHARE)
    .sort(([, a], [, b]) => b - a)
    .map(([kind, share]) => `${Math.round(100 * share)} % ${kind}`);
  const objects = cause.objects.map((object) => `${nameOf(object)} (${milliseconds(object.ms)})`);
  return [work.join(", "), objects.length > 0 && `most by ${objects.join(", ")}`].filter(Boolean).join("; ");
}
