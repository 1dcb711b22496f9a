// What an impostor would be, before anything is recorded: where its reference viewpoint lies, how large its texels are and where its
// layers stand (thesis 3.3, math.md 1.1 and 1.8).
//
// A viewpoint is one (direction, s) to choose from: the shaft's axis, or an axis of the world along which the whole cluster lies beyond
// the box, with the reference viewpoint on the cell's centre line, s behind its near border. No s is best for every layer (thesis 3.3.1),
// so a few are tried on the closed forms and the least number of texels in all layers wins.
//
// The cluster need not be centred before the cell. The layer formulas use its largest slope on either side, so they hold for any part of
// that range; the texture covers only what the cluster really spans.
#include <array>
#include <cmath>

#include "render/base/error.h"
#include "render/impostor/bake.h"

namespace standin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMostParallaxRad = 1.5;  // the layers' formulas need less than a right angle; coarse images may allow more

/// The view cell as a reference viewpoint sees it; see LayerSetup for the terms.
struct Viewpoint {
  ImpostorFrame frame;  // no texture yet
  LayerSetup::Kind kind = LayerSetup::Kind::kShaft;
  Vec2 near_border{0.0};
  double s = 0.0;
  double cell_depth = 0.0;
  Vec2 tan_half{0.0};
};

/// At most six directions with three positions each.
struct Viewpoints {
  std::array<Viewpoint, 18> items;
  std::size_t count = 0;
  void add(const Viewpoint& viewpoint) { items[count++] = viewpoint; }
};

void add_shaft_viewpoints(const Shaft& shaft, Viewpoints& viewpoints) {
  Viewpoint viewpoint;
  viewpoint.kind = LayerSetup::Kind::kShaft;
  viewpoint.near_border = 2.0 * shaft.min_distance_m * shaft.tan_half;
  viewpoint.tan_half = shaft.tan_half;
  viewpoint.frame.forward = -shaft.axis;
  viewpoint.frame.right = shaft.right;
  viewpoint.frame.up = shaft.up;
  const double n = std::max(viewpoint.near_border.x, viewpoint.near_border.y);
  for (const double s : {0.0, 0.5 * n, n}) {
    viewpoint.s = s;
    viewpoint.frame.reference_viewpoint = shaft.apex + (shaft.min_distance_m + s) * shaft.axis;
    viewpoints.add(viewpoint);
  }
}

void add_box_viewpoints(const Box& cell, int axis, double sign, Viewpoints& viewpoints) {
  Viewpoint viewpoint;
  viewpoint.kind = LayerSetup::Kind::kBox;
  viewpoint.frame.forward = Vec3(0.0);
  viewpoint.frame.forward[axis] = sign;
  viewpoint.frame.up = axis == 1 ? Vec3(0.0, 0.0, sign) : Vec3(0.0, 1.0, 0.0);
  viewpoint.frame.right = glm::cross(viewpoint.frame.forward, viewpoint.frame.up);
  viewpoint.near_border = {std::abs(glm::dot(viewpoint.frame.right, cell.size())), std::abs(glm::dot(viewpoint.frame.up, cell.size()))};
  viewpoint.cell_depth = cell.size()[axis];
  for (const double share : {0.0, 0.5, 1.0}) {
    viewpoint.s = share * viewpoint.cell_depth;
    viewpoint.frame.reference_viewpoint = cell.centre() + (0.5 * viewpoint.cell_depth - viewpoint.s) * viewpoint.frame.forward;
    viewpoints.add(viewpoint);
  }
}

/// Directions in which the cluster does not lie wholly beyond the cell are left out.
Viewpoints possible_viewpoints(const Box& object_bounds, const ViewCell& cell) {
  Viewpoints viewpoints;
  if (const auto* shaft = std::get_if<Shaft>(&cell)) {
    add_shaft_viewpoints(*shaft, viewpoints);
    return viewpoints;
  }
  const Box& box = std::get<Box>(cell);
  for (int axis = 0; axis < 3; ++axis) {
    if (object_bounds.min[axis] > box.max[axis]) add_box_viewpoints(box, axis, 1.0, viewpoints);
    if (object_bounds.max[axis] < box.min[axis]) add_box_viewpoints(box, axis, -1.0, viewpoints);
  }
  return viewpoints;
}

/// What the cluster spans, seen from a reference viewpoint.
struct Extent {
  double depth_min = kInfinity;
  double depth_max = -kInfinity;
  Vec2 slope_min{kInfinity};
  Vec2 slope_max{-kInfinity};
  bool in_front = true;  // every point beyond the near border
};

Extent extent_of(std::span<const Vec3> points, const Viewpoint& viewpoint) {
  Extent extent;
  for (const Vec3& point : points) {
    const Vec3 offset = point - viewpoint.frame.reference_viewpoint;
    const double depth = glm::dot(offset, viewpoint.frame.forward);
    if (!(depth > viewpoint.s)) {
      extent.in_front = false;
      return extent;
    }
    const Vec2 slope = Vec2(glm::dot(offset, viewpoint.frame.right), glm::dot(offset, viewpoint.frame.up)) / depth;
    extent.depth_min = std::min(extent.depth_min, depth);
    extent.depth_max = std::max(extent.depth_max, depth);
    extent.slope_min = glm::min(extent.slope_min, slope);
    extent.slope_max = glm::max(extent.slope_max, slope);
  }
  return extent;
}

/// A viewpoint with its texture and the layers that this asks for.
struct Draft {
  const char* why_not = "";
  ImpostorFrame frame;
  double width = 0.0;  // texels; not yet held by the frame where too large
  double height = 0.0;
  LayerSetup setup;
  [[nodiscard]] bool possible() const { return *why_not == '\0'; }
};

/// The texel's slope is what the nearest layer needs not to be magnified, p(t)/t = tau (t + s)/t being largest there. Whole texels are
/// laid around the middle of the slope range.
Draft draft_of(const Viewpoint& viewpoint, const Extent& extent, const Camera& camera, const BakeQuality& quality) {
  Draft draft;
  if (!extent.in_front) return draft.why_not = "cluster reaches into the view cell", draft;
  const double t0 = extent.depth_min - viewpoint.s;
  const double texel = quality.texel_scale / camera.focal_px() * (t0 / extent.depth_min);
  const Vec2 texels = glm::max(glm::ceil((extent.slope_max - extent.slope_min) / texel - 1e-9), Vec2(1.0));
  draft.width = texels.x;
  draft.height = texels.y;
  if (!(std::max(texels.x, texels.y) <= quality.max_resolution)) return draft.why_not = "texture too large", draft;

  const Vec2 middle = 0.5 * (extent.slope_min + extent.slope_max);
  const Vec2 half_range = 0.5 * texel * texels;
  draft.frame = viewpoint.frame;
  draft.frame.slope_min = {middle.x - half_range.x, middle.y + half_range.y};
  draft.frame.slope_step = Vec2(texel);
  draft.frame.width = static_cast<std::uint32_t>(texels.x);
  draft.frame.height = static_cast<std::uint32_t>(texels.y);

  const Vec2 largest_slope = glm::abs(middle) + half_range;
  draft.setup = {.kind = viewpoint.kind,
                 .near_border = viewpoint.near_border,
                 .s = viewpoint.s,
                 .cell_depth = viewpoint.cell_depth,
                 .tan_half = viewpoint.tan_half,
                 .object_width = 2.0 * extent.depth_min * largest_slope,
                 .t0 = t0,
                 .depth = extent.depth_max - extent.depth_min,
                 .resolution = glm::max(2.0 * largest_slope / texel, Vec2(1.0)),
                 .alpha_rad = std::min(quality.alpha_scale * camera.pixel_angle_rad(), kMostParallaxRad),
                 .strict = quality.strict};
  return draft;
}

std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = box.corner(i);
  return corners;
}

struct Choice {
  Viewpoint viewpoint;
  Draft draft;
  double layers = kInfinity;  // estimated
};

/// The viewpoint with the fewest texels in all layers together; the first reason why not, if there is none.
Choice choose_viewpoint(const Box& object_bounds, const ViewCell& cell, const Camera& camera, const BakeQuality& quality) {
  Choice best;
  best.draft.why_not = "cluster reaches into the view cell";
  if (object_bounds.empty()) return best;
  const Viewpoints viewpoints = possible_viewpoints(object_bounds, cell);
  const auto corners = corners_of(object_bounds);
  double least = kInfinity;
  for (std::size_t i = 0; i < viewpoints.count; ++i) {
    Choice choice{viewpoints.items[i], draft_of(viewpoints.items[i], extent_of(corners, viewpoints.items[i]), camera, quality), kInfinity};
    if (choice.draft.possible()) choice.layers = estimated_layer_count(choice.draft.setup);
    const double texels = choice.layers * choice.draft.width * choice.draft.height;
    if (i == 0 || texels < least) best = choice;
    least = std::min(least, texels);
  }
  return best;
}

/// Viewpoint by the box, texels and layers by the points; by the box as well where there are none.
Choice fitted_to(const Choice& by_box, std::span<const Vec3> points, const Camera& camera, const BakeQuality& quality) {
  if (!by_box.draft.possible() || points.empty()) return by_box;
  Choice choice{by_box.viewpoint, draft_of(by_box.viewpoint, extent_of(points, by_box.viewpoint), camera, quality), kInfinity};
  if (choice.draft.possible()) choice.layers = estimated_layer_count(choice.draft.setup);
  return choice;
}

/// More layers than this estimate says are certainly too many: it is off by a few (layers.h).
bool surely_more_than(std::uint32_t max_layers, double estimated_layers) {
  return estimated_layers > 16.0 + 1.25 * max_layers;
}

ImpostorPlan with_layers(const Choice& choice, std::uint32_t max_layers) {
  const Draft& draft = choice.draft;
  ImpostorPlan plan;
  plan.why_not = draft.why_not;
  if (!draft.possible()) return plan;
  if (surely_more_than(max_layers, choice.layers)) return plan.why_not = "too many layers", plan;
  const auto layers = layer_distances(draft.setup, max_layers);
  if (!layers) return plan.why_not = "too many layers", plan;
  plan.possible = true;
  plan.frame = draft.frame;
  plan.setup = draft.setup;
  for (const LayerDistance& layer : *layers)
    plan.layers.push_back({layer.t + draft.setup.s, layer.near + draft.setup.s, layer.far + draft.setup.s});
  return plan;
}

ImpostorSketch sketch_of(const Choice& choice, const Box& object_bounds, std::uint32_t max_layers) {
  const Draft& draft = choice.draft;
  ImpostorSketch sketch;
  sketch.layers = choice.layers <= max_layers ? choice.layers : kInfinity;
  sketch.width_texels = draft.width;
  sketch.height_texels = draft.height;
  if (!draft.possible()) return sketch;
  sketch.distance_m = glm::length(object_bounds.centre() - choice.viewpoint.frame.reference_viewpoint);
  sketch.frame = draft.frame;
  sketch.near_m = draft.setup.t0 + draft.setup.s;
  sketch.far_m = sketch.near_m + draft.setup.depth;
  return sketch;
}

}  // namespace

ImpostorPlan plan_impostor(const Box& object_bounds, const ViewCell& cell, const Camera& camera, const BakeQuality& quality) {
  return with_layers(choose_viewpoint(object_bounds, cell, camera, quality), quality.max_layers);
}

ImpostorPlan plan_impostor(const Box& object_bounds, std::span<const Vec3> points, const ViewCell& cell, const Camera& camera,
                           const BakeQuality& quality) {
  return with_layers(fitted_to(choose_viewpoint(object_bounds, cell, camera, quality), points, camera, quality), quality.max_layers);
}

ImpostorSketch sketch_impostor(const Box& object_bounds, const ViewCell& cell, const Camera& camera, const BakeQuality& quality) {
  return sketch_impostor(object_bounds, {}, cell, camera, quality);
}

ImpostorSketch sketch_impostor(const Box& object_bounds, std::span<const Vec3> points, const ViewCell& cell, const Camera& camera,
                               const BakeQuality& quality) {
  const Choice by_box = choose_viewpoint(object_bounds, cell, camera, quality);
  return sketch_of(fitted_to(by_box, points, camera, quality), object_bounds, quality.max_layers);
}

}  // namespace standin
