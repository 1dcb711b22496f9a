// metrics.json and sweep.json as far as the result views read them; everything may be missing.

export type Triple = [number, number, number];
/// What the bound of a slowest region is made of.
export interface Cause {
  draws_share: number;
  triangles_share: number;
  pixels_share: number;
  objects: { object: number; name: string; ms: number }[]; // heaviest first, a few
}
export interface HeatCell {
  x0: number;
  z0: number;
  x1: number;
  z1: number;
  before_ms: number;
  after_ms?: number | null;
  cause?: Cause | null;
}
export interface ViewTime {
  position: Triple;
  direction: Triple;
  frame_ms: number;
}
export interface VerifiedFrame {
  position: Triple;
  direction: Triple;
  origin: string;
  cpv: number | null;
  before_ms: number | null;
  after_ms: number | null;
  estimated_before_ms: number | null;
  estimated_after_ms: number | null;
  mean_error: number | null;
  mean_flip: number | null;
}
/// The file holds a verified frame without and with impostors and the difference of the two, side by side.
export interface FramePicture {
  file: string;
  frame: number; // index into the frames
}
export interface Unsolved {
  cpv: number;
  region?: string;
  bound_before_ms: number;
  lowest_budget_ms: number;
  residual_ms: number;
  blocking?: { object: number; name?: string; ms?: number }[];
}

export interface Metrics {
  mode?: string;
  budget_ms?: number;
  scene?: { objects: number; triangles: number };
  target?: { id: string; coverage?: number };
  cpv?: { count: number; solved?: number; unsolved?: number };
  impostors?: { count: number };
  memory?: { texture_bytes?: number; geometry_bytes?: number; lods_bytes?: number; atlas_padding_bytes?: number; total_bytes?: number };
  bound?: { gap?: number; memory_lower_bound_bytes?: number };
  survey?: {
    verdict?: string;
    worst_frame_ms?: number;
    worst_bound_ms?: number;
    reachable_all_ms?: number | null;
    worst_views?: ViewTime[];
  };
  verify?: {
    views: number;
    over_budget_measured: number | null;
    over_budget_estimated: number | null;
    worst_over_budget?: number | null;
    measured_coverage?: number | null;
    frames?: VerifiedFrame[];
    pictures?: FramePicture[];
    left_out?: string[];
  };
  causes?: {
    draws_share?: number;
    triangles_share?: number;
    pixels_share?: number;
    objects?: { object: number; name: string; ms: number }[];
  };
  heat_map?: HeatCell[];
  unsolved?: Unsolved[];
}

export interface SweepPoint {
  budget_ms: number;
  met: boolean;
  texture_bytes: number;
  total_bytes: number;
  memory_lower_bound_bytes: number;
  impostors: number;
  cpv: { count: number; unsolved: number };
}
export interface SweepRegression {
  budget_ms: number;
  kind: "memory" | "unsolved";
  before: number;
  after: number;
  sentence: string;
}
export interface Sweep extends Pick<Metrics, "scene" | "target"> {
  points: SweepPoint[];
  budgets_from: string;
  baseline?: { tolerance: number; compared_ms: number[]; not_compared_ms: number[]; regressions: SweepRegression[] };
  acceptance?: { passed: boolean; sentence: string }[];
  passed: boolean; // every budget is met or excused, and no gate failed
}
