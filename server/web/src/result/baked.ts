// A baked impostor's result (metrics.json of a bake): what it is made of, what it weighs, and how close its image comes, as its file is read.

import { artifactOf, type Artifact, type Job } from "../api";
import { artifactLink } from "../artifact_link";
import { withSource } from "../artifact_source";
import { element, section, table } from "../elements";
import { bytes, count, isNumber, percent, significant } from "../text";
import { tileList, verdictBox } from "./summary";

interface Errors {
  readonly mean_error: number | null;
  readonly mean_flip: number | null;
}
interface Image extends Errors {
  readonly views: number;
  readonly judged_pixels: number;
  readonly gap_pixels: number;
  readonly max_parallax_ratio: number;
  readonly silhouette_bloat_px: number | null;
  readonly at_reference: Errors;
  readonly samplings: Readonly<Record<string, { readonly gap_pixels: number; readonly silhouette_bloat_px: number | null }>>;
}
export interface Baked {
  readonly technique: string;
  readonly guarantee?: string;
  readonly layers: number;
  readonly quads: number;
  readonly triangles: number;
  readonly resolution: readonly [number, number];
  readonly texels: number;
  readonly texture_bytes: number;
  readonly geometry_bytes: number;
  readonly gpu_bytes?: Readonly<Record<string, number>>;
  readonly image: Image | null;
}

function verdict({ guarantee, image }: Baked): HTMLElement {
  if (image === null) return verdictBox("plain", "Baked", "its image was not judged: no views were asked for.");
  const found = `rays in ${count(image.views)} views of its view cell found ${image.gap_pixels === 0 ? "no gap" : `${count(image.gap_pixels)} gap pixels`} and a parallax of at most ${significant(image.max_parallax_ratio, 3)} of what is allowed.`;
  if (guarantee === "none") return verdictBox("plain", "Baked, without a promise", found);
  return image.gap_pixels === 0 && image.max_parallax_ratio <= 1
    ? verdictBox("good", "Image promise kept", found)
    : verdictBox("bad", "Image promise broken", found);
}

function tiles(baked: Baked): HTMLElement {
  const { layers, quads, triangles, resolution, texels } = baked;
  return tileList([
    {
      title: "Textures",
      figure: bytes(baked.texture_bytes),
      note: `${count(texels)} texels; ${resolution.join(" \u00d7 ")} over the whole image`,
    },
    { title: "Geometry", figure: bytes(baked.geometry_bytes), note: quads > 0 ? `${count(quads)} quads` : `${count(triangles)} triangles` },
    { title: "Layers", figure: count(layers), note: baked.technique },
    ...(baked.image === null
      ? []
      : [
          {
            title: "Image error",
            figure: percent(baked.image.mean_error),
            note: `of covered pixels; FLIP ${significant(baked.image.mean_flip, 2)}`,
          },
        ]),
  ]);
}

function errors({ image }: Baked): HTMLElement | null {
  if (image === null) return null;
  const rows = [
    { name: `mean of ${count(image.views)} views`, ...image },
    { name: "from the reference viewpoint", ...image.at_reference },
  ];
  type Row = (typeof rows)[number];
  const columns = [
    { title: "image error", cell: ({ name }: Row) => name },
    { title: "absolute difference of colour", number: true, cell: ({ mean_error }: Row) => percent(mean_error) },
    { title: "FLIP, 0 to 1", number: true, cell: ({ mean_flip }: Row) => significant(mean_flip, 2) },
  ];
  const samplings = Object.entries(image.samplings);
  type Sampling = (typeof samplings)[number];
  const sampled = [
    { title: "texture sampling", cell: ([name]: Sampling) => name },
    { title: "gap pixels", number: true, cell: ([, { gap_pixels }]: Sampling) => count(gap_pixels) },
    {
      title: "silhouette too wide by, px",
      number: true,
      cell: ([, { silhouette_bloat_px }]: Sampling) => significant(silhouette_bloat_px, 2),
    },
  ];
  return section(
    "errors",
    "How close its image comes",
    `Over pixels that the original or the impostor covers; rays judged ${count(image.judged_pixels)} pixels. The promise is about nearest sampling.`,
    table(columns, rows, "Image errors"),
    table(sampled, samplings, "Gaps and silhouettes by texture sampling"),
  );
}

function sizes({ gpu_bytes: formats = {} }: Baked): HTMLElement | null {
  const rows = Object.entries(formats)
    .filter(([, size]) => isNumber(size))
    .sort(([, a], [, b]) => b - a);
  if (rows.length === 0) return null;
  const columns = [
    { title: "texture format", cell: ([format]: (typeof rows)[number]) => format.toUpperCase().replaceAll("_", " ") },
    { title: "on a GPU", number: true, cell: ([, size]: (typeof rows)[number]) => bytes(size) },
  ];
  return section("gpu", "On a GPU", "", table(columns, rows, "Size on a GPU by texture format"));
}

function picture(file: Artifact, signal: AbortSignal): HTMLElement {
  const image = element("img", { alt: file.path }),
    link = element("a", { target: "_blank", "aria-label": `${file.path} in full size` }, image);
  const fail = () => link.replaceWith(element("p", { class: "soft" }, `${file.path} cannot be loaded.`));
  image.addEventListener("error", fail);
  withSource(file, signal, (address) => (image.src = link.href = address), fail);
  return element("figure", {}, link, element("figcaption", {}, file.path));
}

function pictures(job: Job, signal: AbortSignal): HTMLElement | null {
  const files = job.artifacts.filter(({ type }) => type === "image/png");
  return files.length === 0 ? null : section("pictures", "Pictures", "", ...files.map((file) => picture(file, signal)));
}

function contextText({ technique }: Baked, job: Job): string {
  const { objects } = job.request.arguments ?? {};
  return [
    `${technique} impostor`,
    typeof objects === "string" && `${/^\d+$/.test(objects) ? "object" : "objects"} ${objects}`,
    job.scene?.name,
  ]
    .filter(Boolean)
    .join(" of ");
}

/// Above the numbers: the impostor itself.
export function impostorLink(job: Job): HTMLElement | null {
  const file = artifactOf(job, "impostors.glb");
  return file === undefined ? null : artifactLink(file, `impostors.glb, ${bytes(file.bytes)}`, { save: true, class: "button primary" });
}

export function bakedView(baked: Baked, job: Job, ways: HTMLElement, signal: AbortSignal): (HTMLElement | null)[] {
  return [
    element("p", { class: "context" }, contextText(baked, job)),
    verdict(baked),
    tiles(baked),
    ways,
    pictures(job, signal),
    errors(baked),
    sizes(baked),
  ];
}
