// Files of the made-up jobs: a real result's, with what it has not.
import { readFileSync } from "node:fs";
import { join } from "node:path";

import { png } from "./png.mjs";

const PANE = 96; // pixels

const readMetrics = (folder) => JSON.parse(readFileSync(join(folder, "metrics.json"), "utf8"));
const json = (value) => Buffer.from(JSON.stringify(value));

/// A house before a sky; with impostors, a little to the right; and the difference.
function worstView(shift) {
  const scene = (x, y) => (x > 30 && x < 66 && y > 40 && y < 84 ? [150, 90, 70] : y > 80 ? [90, 110, 80] : [150, 180, 210]);
  return png(3 * PANE, PANE, (column, y) => {
    const pane = Math.floor(column / PANE),
      x = column % PANE,
      before = scene(x, y),
      after = scene(x - shift, y);
    return [before, after, before.map((value, i) => Math.min(255, 4 * Math.abs(value - after[i])))][pane];
  });
}

/// As results were before they had causes and pictures.
function older(metrics) {
  const heat_map = metrics.heat_map.map(({ cause: _, ...cell }) => cell);
  const { pictures: _, ...verify } = metrics.verify;
  return { ...metrics, heat_map, verify };
}

/// The slowest cell has a cause, and the one after it one whose object has no name.
function withCauses({ heat_map, ...metrics }) {
  const [slowest, next] = [...heat_map].sort((a, b) => b.before_ms - a.before_ms);
  const cause = (cell) => ({
    draws_share: 0.02,
    triangles_share: 0.8,
    pixels_share: 0.18,
    objects: [
      { object: 17, name: cell === slowest ? "tree_03" : "", ms: 12.3 },
      { object: 4, name: "house_4", ms: 3.04 },
    ],
  });
  return { ...metrics, heat_map: heat_map.map((cell) => (cell === slowest || cell === next ? { ...cell, cause: cause(cell) } : cell)) };
}

/// The second one's frame was timed with impostors, but not before.
function withPictures({ verify, ...metrics }) {
  const pictures = [3, 0].map((frame, i) => ({ file: `worst_view_${i + 1}.png`, frame }));
  const frames = verify.frames.map((frame, i) => (i === 0 ? { ...frame, after_ms: 0.9 * frame.estimated_after_ms } : frame));
  return { ...metrics, verify: { ...verify, frames, pictures } };
}

export const olderFiles = (folder) => ({ "metrics.json": json(older(readMetrics(folder))), "result.json": json({}) });
export const explainedFiles = (folder) => ({
  "metrics.json": json(withPictures(withCauses(older(readMetrics(folder))))),
  "worst_view_1.png": worstView(1),
  "worst_view_2.png": worstView(3),
});

/// A budget that no view exceeds.
export function needlessFiles(folder) {
  const metrics = older(readMetrics(folder));
  const memory = { texture_bytes: 0, geometry_bytes: 0, lods_bytes: 0, atlas_padding_bytes: 0, total_bytes: 0 };
  return {
    "metrics.json": json({
      ...metrics,
      memory,
      cpv: { count: 0, solved: 0, unsolved: 0 },
      impostors: { count: 0 },
      bound: { gap: 0, memory_lower_bound_bytes: 0 },
    }),
  };
}

/// As if timed here: each frame took what it is estimated, but for `slow` of them. `repeats`: each is there so many times.
export function verifiedFiles(folder, slow, repeats = 1) {
  const { verify, image, budget_ms } = older(readMetrics(folder));
  const frames = Array.from({ length: repeats }, () => verify.frames)
    .flat()
    .map((frame, i) => ({
      ...frame,
      before_ms: frame.estimated_before_ms,
      after_ms: i < slow ? 1.25 * budget_ms : Math.min(frame.estimated_after_ms, 0.9 * budget_ms),
    }));
  const worst_over_budget = Math.max(...frames.map(({ after_ms }) => after_ms)) / budget_ms;
  const timed = {
    ...verify,
    left_out: verify.left_out.filter((text) => !text.startsWith("frame times")),
    frames,
    views: frames.length,
    over_budget_estimated: 0,
    over_budget_measured: slow,
    worst_over_budget,
    measured_coverage: 1 - slow / (2 * frames.length),
  };
  return { "verify.json": json({ verify: timed, image }), "result.json": json({ image }) };
}

/// Not timed here; `gap_pixels` holes were found.
export function untimedFiles(folder, gap_pixels) {
  const { verify, image } = older(readMetrics(folder));
  const frames = verify.frames.map((frame) => ({ ...frame, before_ms: null, after_ms: null }));
  const untimed = {
    ...verify,
    frames,
    over_budget_estimated: 0,
    over_budget_measured: null,
    worst_over_budget: null,
    measured_coverage: null,
  };
  return { "verify.json": json({ verify: untimed, image: { ...image, gap_pixels } }) };
}

const point = (budget_ms, texture_bytes, unsolved) => ({
  budget_ms,
  met: unsolved === 0,
  texture_bytes,
  total_bytes: 1.06 * texture_bytes,
  memory_lower_bound_bytes: 0.3 * texture_bytes,
  impostors: Math.round(texture_bytes / 5000),
  cpv: { count: texture_bytes > 0 ? 72 : 0, unsolved },
});

export const sweptFiles = () => ({
  "sweep.json": json({
    budgets_from: "10 between what is reachable and what is needless",
    passed: false,
    scene: { objects: 150, triangles: 149994 },
    target: { id: "reference (llvmpipe, 2026)" },
    points: [point(42, 0, 0), point(40, 95_000, 0), point(38, 175_828, 0), point(36, 262_144, 5)],
  }),
});

const MET = [point(42, 0, 0), point(40, 95_000, 0), point(38, 300_000, 0)];

/// Every budget is met, but not as cheaply as before.
export const regressedFiles = () => ({
  "sweep.json": json({
    budgets_from: "those of the baseline",
    passed: false,
    points: MET,
    unmet_ms: [],
    baseline: {
      tolerance: 0.02,
      compared_ms: [38, 40, 42],
      not_compared_ms: [36],
      regressions: [
        {
          budget_ms: 38,
          kind: "memory",
          before: 175_828,
          after: 300_000,
          sentence: "at 38 ms: 175828 bytes of texture before, 300000 now (+71 %)",
        },
      ],
      points: [],
    },
  }),
});

/// Every budget is met, but not a criterion.
export const unacceptedFiles = () => ({
  "sweep.json": json({
    budgets_from: "those of the criteria",
    passed: false,
    points: MET,
    unmet_ms: [],
    acceptance: [
      { target: "reference", budget_ms: 40, max_unsolved: 0, passed: true, sentence: "at 40 ms: passed" },
      {
        target: "reference",
        budget_ms: 38,
        max_unsolved: 0,
        passed: false,
        sentence: "at 38 ms: failed, 300000 bytes of texture, 200000 allowed",
      },
    ],
  }),
});

const judged = (gap_pixels, silhouette_bloat_px) => ({ gap_pixels, silhouette_bloat_px });

export const bakedFiles = (folder) => ({
  "impostors.glb": readFileSync(join(folder, "impostors.glb")),
  "picture.png": worstView(2),
  "metrics.json": json({
    technique: "layered",
    guarantee: "nearest",
    layers: 25,
    quads: 148,
    triangles: 296,
    resolution: [53, 146],
    texels: 79124,
    texture_bytes: 370720,
    geometry_bytes: 13616,
    gpu_bytes: { bc1: 46340, bc7: 92680, rgba8: 370720 },
    image: {
      views: 50,
      judged_pixels: 148303,
      gap_pixels: 0,
      max_parallax_ratio: 0.9502,
      silhouette_bloat_px: 0.584,
      mean_error: 0.0257,
      mean_flip: 0.113,
      at_reference: { mean_error: 0.0209, mean_flip: 0.0989 },
      samplings: { nearest: judged(0, 0.584), bilinear: judged(0, 0.583), mipmapped: judged(149, 0.577) },
    },
  }),
});
