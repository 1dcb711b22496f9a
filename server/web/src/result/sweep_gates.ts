// What a sweep is held against, beside its budgets: an earlier curve (the baseline) and criteria. A curve that meets every budget may still
// be worse than the one before it.

import { element, section, table } from "../elements";
import { bytes, count, milliseconds, percent } from "../text";
import type { Sweep, SweepRegression } from "./metrics";
import { verdictBox } from "./summary";

const failedCriteria = ({ acceptance = [] }: Sweep) => acceptance.filter(({ passed }) => !passed);

/// The first reasons as the server words them; the sections below have all of them.
function named(reasons: readonly { readonly sentence: string }[]): string {
  const first = reasons.slice(0, 2).map(({ sentence }) => sentence);
  return `${[...first, reasons.length > first.length && `and ${count(reasons.length - first.length)} more`].filter(Boolean).join("; ")}.`;
}

/// null: no gate failed.
export function failedGate(sweep: Sweep): HTMLElement | null {
  const regressions = sweep.baseline?.regressions ?? [],
    failed = failedCriteria(sweep);
  if (regressions.length > 0) return verdictBox("bad", "Worse than the baseline", named([...regressions, ...failed]));
  return failed.length > 0 ? verdictBox("bad", "Criteria not met", named(failed)) : null;
}

const figure = (kind: SweepRegression["kind"], value: number) => (kind === "memory" ? bytes(value) : `${count(value)} unsolved`);

export function sinceBaseline({ baseline }: Sweep): HTMLElement | null {
  if (baseline === undefined) return null;
  const { regressions, compared_ms, not_compared_ms } = baseline;
  const apart =
    not_compared_ms.length === 0 ? "" : ` Not in both curves, so not compared: ${not_compared_ms.map(milliseconds).join(", ")}.`;
  const columns = [
    { title: "budget", number: true, cell: (one: SweepRegression) => milliseconds(one.budget_ms) },
    { title: "before", number: true, cell: (one: SweepRegression) => figure(one.kind, one.before) },
    { title: "now", number: true, cell: (one: SweepRegression) => figure(one.kind, one.after) },
  ];
  return section(
    "baseline",
    "Since the baseline",
    `${count(compared_ms.length)} budgets compared; memory may grow by ${percent(baseline.tolerance)}.${apart}`,
    regressions.length === 0 ? element("p", {}, "Nothing is worse.") : table(columns, regressions, "Regressions"),
  );
}

export function criteria({ acceptance = [] }: Sweep): HTMLElement | null {
  if (acceptance.length === 0) return null;
  return section("criteria", "Criteria", "", element("ul", {}, ...acceptance.map(({ sentence }) => element("li", {}, sentence))));
}
