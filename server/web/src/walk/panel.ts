// What is drawn at the viewer's place, and why: beside the picture, in words.

import { element, folded, replaceIfChanged } from "../elements";
import type { ViewContent } from "../runtime/content";
import type { Lookup } from "../runtime/lookup";
import type { Placement } from "../runtime/placement";
import { bytes, count, listed, milliseconds, significant } from "../text";
import type { Pose } from "./movement";
import type { FrameCost } from "./stage";

export interface WalkState {
  readonly pose: Pose;
  readonly lookup: Lookup;
  readonly content: ViewContent;
  readonly impostorsOn: boolean;
  readonly without: FrameCost; // the same view with no impostors
  readonly with: FrameCost;
}

function place(placement: Placement, { lookup }: WalkState): HTMLElement {
  if (lookup.cell === null)
    return element(
      "p",
      { class: "verdict bad" },
      element("strong", {}, "Outside the view space"),
      "All objects are drawn as they are; nothing is promised here. Press B to go back.",
    );
  const cell = placement.cells[lookup.cell]!;
  const seen =
    cell.visible_objects === null
      ? "all objects"
      : `${count(cell.visible_objects.length)} of ${count(placement.scene.objects.length)} objects`;
  if (lookup.cpv === null)
    return element(
      "p",
      { class: "verdict good" },
      element("strong", {}, "Fast enough as it is"),
      `Cell ${lookup.cell} may see ${seen}. No view in this direction exceeds ${milliseconds(placement.budget_ms)}, so none of them needs an impostor.`,
    );
  const { solved, bound_before_ms, bound_after_ms } = placement.cpvs[lookup.cpv]!;
  const change = `${milliseconds(bound_before_ms)} before, ${milliseconds(bound_after_ms)} with impostors, budget ${milliseconds(placement.budget_ms)}`;
  return element(
    "p",
    { class: `verdict ${solved ? "good" : "bad"}` },
    element("strong", {}, solved ? "Slow view, solved" : "Slow view, not solved"),
    `Region ${lookup.cpv}: cell ${lookup.cell} may see ${seen}; time bound ${change}.`,
  );
}

function costs(state: WalkState): HTMLElement {
  const row = (name: string, cost: FrameCost, current: boolean) =>
    element(
      "tr",
      { "aria-current": current && "true" },
      element("th", { scope: "row" }, name),
      element("td", { class: "number" }, count(cost.draws)),
      element("td", { class: "number" }, count(cost.triangles)),
    );
  return element(
    "table",
    { "aria-label": "Frame statistics" },
    element(
      "thead",
      {},
      element(
        "tr",
        {},
        element("th", { scope: "col" }, "In this view"),
        element("th", { scope: "col", class: "number" }, "draw calls"),
        element("th", { scope: "col", class: "number" }, "triangles"),
      ),
    ),
    element("tbody", {}, row("without impostors", state.without, !state.impostorsOn), row("with impostors", state.with, state.impostorsOn)),
  );
}

function impostorItem(placement: Placement, id: number): HTMLElement {
  const impostor = placement.impostors[id]!;
  const names = impostor.objects.map((object) => placement.scene.objects[object]!.name);
  const promise = impostor.guarantee === "none" ? "no promise about its image" : `image promise at ${impostor.guarantee} texels`;
  return element(
    "li",
    {},
    element("strong", {}, impostor.gltf_node),
    ` \u2014 ${impostor.technique}, ${promise}; at most ${milliseconds(impostor.time_bound_ms)}, ${bytes(impostor.texture_bytes)} of texture`,
    element(
      "div",
      { class: "soft" },
      `stands for ${count(names.length)} ${names.length === 1 ? "object" : "objects"}: ${listed(names, 6)}`,
    ),
  );
}

function impostorList(placement: Placement, { lookup, impostorsOn }: WalkState): HTMLElement {
  const ids = lookup.cpv === null ? [] : placement.cpvs[lookup.cpv]!.impostors;
  const title =
    ids.length === 0
      ? "No impostor here"
      : `${count(ids.length)} ${ids.length === 1 ? "impostor" : "impostors"}${impostorsOn ? "" : ", switched off"}`;
  return element(
    "div",
    {},
    element("h2", {}, title),
    ids.length > 0 && element("ul", { class: "plain" }, ...ids.map((id) => impostorItem(placement, id))),
  );
}

function objectList(placement: Placement, { content }: WalkState): HTMLElement {
  const simpler = content.levels.filter((level) => level > 0).length;
  const names = content.objects.map((id) => placement.scene.objects[id]!.name);
  return folded(
    `${count(content.objects.length)} objects as originals${simpler > 0 ? `, ${count(simpler)} of them in a simpler form` : ""}`,
    element("p", { class: "soft" }, listed(names, 200)),
  );
}

const triple = (values: readonly number[]) => values.map((value) => significant(value, 4)).join(", ");

export function fillPanel(host: HTMLElement, placement: Placement, state: WalkState): void {
  const wasOpen = host.querySelector("details")?.open === true;
  const objects = objectList(placement, state) as HTMLDetailsElement;
  objects.open = wasOpen;
  const { position, direction } = state.pose;
  replaceIfChanged(
    host,
    place(placement, state),
    costs(state),
    impostorList(placement, state),
    objects,
    element("p", { class: "soft" }, `position ${triple(position)} m; direction ${triple(direction)}`),
  );
}
