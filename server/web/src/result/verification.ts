// A verification's result (verify.json): whether the views that were drawn kept the budget and their images, against what the placement that
// it verified says.

import { count, isNumber, percent, significant } from "../text";
import { element, section, table } from "../elements";
import type { Metrics } from "./metrics";
import { tileList, verdictBox, type Tile } from "./summary";

interface Image {
  readonly views: number; // judged by rays
  readonly gap_pixels: number | null;
  readonly max_parallax_ratio: number | null;
  readonly baseless_pixel_share: number | null;
  readonly silhouette_bloat_px: number | null;
  readonly mean_error: number;
  readonly mean_flip: number;
  readonly lods_mean_error?: number;
  readonly lods_mean_flip?: number;
}
export interface Verification {
  readonly verify: NonNullable<Metrics["verify"]>;
  readonly image: Image;
}

const BUDGET = "the budget";
const SLOWER_ALLOWED = percent(0.01); // of the frames: so many `verify` lets pass

/// The worst that was found comes first. Whether the budget was kept is the job's to say (`aimMet`): it may let a few frames be slower.
export function verificationVerdict({ verify, image }: Verification, aimMet: boolean | null, budget = BUDGET): HTMLElement {
  const { views, over_budget_measured: slow } = verify;
  const images = imageText(image);
  if ((image.gap_pixels ?? 0) > 0 || (image.max_parallax_ratio ?? 0) > 1) return verdictBox("bad", "Image promise broken", `${images}.`);
  if (aimMet === false)
    return verdictBox("bad", "Budget missed", `${count(slow)} of ${count(views)} frames took longer than ${budget}; ${images}.`);
  if (slow === null) return verdictBox("plain", "Not timed here", `${estimatesText(verify, budget)}, but none was timed; ${images}.`);
  return verdictBox(
    "good",
    "Verified",
    slow > 0
      ? `${count(slow)} of ${count(views)} frames took longer than ${budget}, ${SLOWER_ALLOWED} may; ${images}.`
      : `all of ${count(views)} frames kept ${budget}; ${images}.`,
  );
}

const estimatesText = ({ views, over_budget_estimated: slow }: Verification["verify"], budget: string) =>
  (slow ?? 0) > 0
    ? `${count(slow)} of ${count(views)} frames are estimated to take longer than ${budget}`
    : `all of ${count(views)} frames are estimated within ${budget}`;

const imageText = ({ views, gap_pixels, max_parallax_ratio }: Image) =>
  isNumber(gap_pixels)
    ? `rays in ${count(views)} views found ${gap_pixels === 0 ? "no gap" : `${count(gap_pixels)} gap pixels`} and a parallax of at most ${significant(max_parallax_ratio, 3)} of what is allowed`
    : "no image was judged by rays";

export function verificationTiles({ verify, image }: Verification): HTMLElement {
  const { worst_over_budget: worst, measured_coverage: coverage } = verify;
  const tiles: (Tile | false)[] = [
    isNumber(worst) && { title: "Slowest frame with impostors", figure: percent(worst), note: "of the budget, measured" },
    isNumber(coverage) && { title: "Frames within their bound", figure: percent(coverage), note: "measured, before and with impostors" },
    isNumber(image.gap_pixels) && {
      title: "Gap pixels",
      figure: count(image.gap_pixels),
      note: `holes, in ${count(image.views)} judged views; 0 is promised`,
    },
    isNumber(image.max_parallax_ratio) && {
      title: "Greatest parallax",
      figure: significant(image.max_parallax_ratio, 3),
      note: "of the angle allowed; at most 1 is promised",
    },
    { title: "Image error", figure: percent(image.mean_error), note: `mean of the pictures; FLIP ${significant(image.mean_flip, 2)}` },
  ];
  return tileList(tiles.filter((tile) => tile !== false));
}

export function imageErrors({ verify, image }: Verification): HTMLElement {
  const rows = (
    [
      ["views with impostors", image.mean_error, image.mean_flip],
      ["views with levels of detail, without impostors", image.lods_mean_error, image.lods_mean_flip],
    ] as const
  ).filter(([, error]) => isNumber(error));
  const columns = [
    { title: "mean over", cell: (row: (typeof rows)[number]) => row[0] },
    { title: "absolute difference of colour", number: true, cell: (row: (typeof rows)[number]) => percent(row[1]) },
    { title: "FLIP, 0 to 1", number: true, cell: (row: (typeof rows)[number]) => significant(row[2], 2) },
  ];
  const facts = [
    isNumber(image.silhouette_bloat_px) && `silhouettes are ${significant(image.silhouette_bloat_px, 2)} pixels too wide on average`,
    isNumber(image.baseless_pixel_share) &&
      `${percent(image.baseless_pixel_share)} of the impostors' pixels show what has no original to compare with`,
  ].filter(Boolean);
  const left = verify.left_out ?? [];
  return section(
    "images",
    "Image errors",
    facts.length > 0 ? `Where rays judged: ${facts.join("; ")}.` : "",
    table(columns, rows, "Image errors"),
    left.length > 0 && element("h3", {}, "Left out"),
    left.length > 0 && element("ul", {}, ...left.map((text) => element("li", {}, text))),
  );
}
