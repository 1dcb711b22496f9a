// What a result says first: the verdict, and its main figures as tiles.

import { element } from "../elements";

export type Tone = "good" | "bad" | "plain";

export const verdictBox = (tone: Tone, word: string, sentence: string) =>
  element("div", { class: `verdict ${tone}` }, element("strong", {}, word), element("span", {}, sentence));

export interface Tile {
  readonly title: string;
  readonly figure: string;
  readonly note?: string;
}

export const tileList = (tiles: readonly Tile[]) =>
  element(
    "dl",
    { class: "tiles" },
    ...tiles.map(({ title, figure, note = "" }) =>
      element(
        "div",
        { class: "tile" },
        element("dt", {}, title),
        element("dd", { class: "figure" }, figure),
        note !== "" && element("dd", { class: "note" }, note),
      ),
    ),
  );
