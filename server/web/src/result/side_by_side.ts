// Worst views side by side. A view comes as one file of three panes in a row; here each pane stands under its head, beside the others where
// there is room and below them where there is not, and the whole opens in full size.

import type { Artifact } from "../api";
import { withSource } from "../artifact_source";
import { element } from "../elements";
import { walkAddress } from "../router";
import { isNumber, milliseconds, percent, significant } from "../text";
import type { Metrics, Triple, VerifiedFrame } from "./metrics";

const PANES = ["Original", "With impostors", "Difference, amplified 4\u00d7"] as const;
const ROOM = { width: PANES.length, height: 1 }; // a file's proportions, until it has come

export interface Pictures {
  readonly verify: Metrics["verify"];
  readonly artifacts: readonly Artifact[];
  readonly walkId: string | null; // null: nothing to walk through
  readonly signal: AbortSignal;
}

export const placeText = (position: Triple) => position.map((value) => significant(value, 4)).join(", ");

export function walkLink(id: string, { position, direction }: { position: Triple; direction: Triple }): HTMLElement {
  return element("a", { href: walkAddress(id, position, direction), "aria-label": `walk there: ${placeText(position)}` }, "walk there");
}

/// As it was measured, or estimated where it was not.
export const frameTime = (frame: VerifiedFrame, when: "before" | "after") => frame[`${when}_ms`] ?? frame[`estimated_${when}_ms`];

function timeText(frame: VerifiedFrame, when: "before" | "after"): string {
  const how = isNumber(frame[`${when}_ms`]) ? "" : " (estimated)"; // one of a frame's two may be timed without the other
  return `${milliseconds(frameTime(frame, when))}${how}`;
}

function captionText(frame: VerifiedFrame): string {
  return `${timeText(frame, "before")} before, ${timeText(frame, "after")} with impostors; image error ${percent(frame.mean_error)}, FLIP ${significant(frame.mean_flip, 2)}; at ${placeText(frame.position)} m`;
}

function panes(name: string, artifact: Artifact, signal: AbortSignal): HTMLElement {
  const images = PANES.map((head) => element("img", { alt: `${name}: ${head.toLowerCase()}`, loading: "lazy", ...ROOM }));
  const link = element(
    "a",
    { class: "panes", target: "_blank", title: "Opens in full size" },
    ...PANES.map((head, i) => element("span", { class: "pane" }, head, element("span", { class: "crop" }, images[i]))),
  );
  const fail = () => link.replaceWith(element("p", { class: "soft" }, `${artifact.path} cannot be loaded.`));
  images[0]!.addEventListener("error", fail);
  const use = (address: string) => {
    link.href = address;
    for (const image of images) image.src = address;
  };
  withSource(artifact, signal, use, fail);
  return link;
}

function figure(name: string, artifact: Artifact, frame: VerifiedFrame, { walkId, signal }: Pictures): HTMLElement {
  const caption = element(
    "figcaption",
    {},
    element("strong", {}, name),
    ` \u2014 ${captionText(frame)}`,
    walkId !== null && " \u00b7 ",
    walkId !== null && walkLink(walkId, frame),
  );
  return element("figure", { class: "worst-view" }, caption, panes(name, artifact, signal));
}

/// One figure per frame whose file is there.
export function sideBySide(shown: Pictures): HTMLElement[] {
  return (shown.verify?.pictures ?? []).flatMap(({ file, frame: index }, i) => {
    const artifact = shown.artifacts.find(({ path }) => path === file);
    const frame = shown.verify?.frames?.[index];
    return artifact === undefined || frame === undefined ? [] : [figure(`Worst view ${i + 1}`, artifact, frame, shown)];
  });
}
