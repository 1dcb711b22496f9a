#include "placement/view_space/view_space.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/number_text.h"
#include "render/base/error.h"
#include "render/base/placement_lookup.h"

namespace standin {
namespace {

// 2^kDeepestLevel cubes a side still fit an int with room for children.
constexpr int kDeepestLevel = 28;

void require(bool holds, const std::string& sentence) {
  if (!holds) throw Failure(ErrorWord::kBadUsage, sentence);
}

void check_options(const ViewSpaceOptions& options) {
  require(std::isfinite(options.leaf_m) && options.leaf_m > 0.0,
          "view space: leaf side " + number_text(options.leaf_m) + " m must be finite and positive");
  require(options.refine_levels >= 0 && options.refine_levels <= 8,
          "view space: " + std::to_string(options.refine_levels) + " refinement levels, 0..8 are possible");
  require(options.max_leaves >= 1, "view space: at least one leaf must be allowed");
}

void check_box(const Box& box) {
  const bool finite = std::isfinite(box.min.x + box.min.y + box.min.z + box.max.x + box.max.y + box.max.z);
  require(finite && !box.empty(), "view space: box from (" + number_text(box.min.x) + ", " + number_text(box.min.y) + ", " +
                                      number_text(box.min.z) + ") to (" + number_text(box.max.x) + ", " + number_text(box.max.y) + ", " +
                                      number_text(box.max.z) + ") must be finite, min <= max");
}

bool grid_covers(const ViewSpace& space, const Vec3& corner) {
  const Vec3 end = space.cube({0, {0, 0, 0}}).max;
  return corner.x <= end.x && corner.y <= end.y && corner.z <= end.z;
}

// The smallest grid of leaves of `leaf_m` that covers the boxes.
void lay_grid(ViewSpace& space, double leaf_m, int refine_levels) {
  const Box bounds = space.bounds();
  space.root_min = bounds.min;
  space.leaf_level = 0;
  space.root_side_m = leaf_m;
  while (!grid_covers(space, bounds.max)) {
    space.root_side_m *= 2.0;
    ++space.leaf_level;
    require(space.leaf_level + refine_levels <= kDeepestLevel,
            "view space: leaves of " + number_text(leaf_m) + " m are too small for an extent of " + number_text(bounds.diagonal()) + " m");
  }
  space.finest_level = space.leaf_level + refine_levels;
}

double volume(const Box& box) {
  double product = 1.0;
  for (int axis = 0; axis < 3; ++axis)
    if (box.max[axis] > box.min[axis]) product *= box.max[axis] - box.min[axis];
  return product;
}

}  // namespace

Box DyadicGrid::cube(const CellKey& key) const {
  // Halving is exact, so the borders of all levels are roundings of the same real numbers.
  const double side = std::ldexp(root_side_m, -key.level);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const int i = key.index[static_cast<std::size_t>(axis)];
    box.min[axis] = slab_border(root_min[axis], side, i);
    box.max[axis] = slab_border(root_min[axis], side, i + 1);
  }
  return box;
}

int DyadicGrid::index_at(double coordinate, int axis, int level) const {
  return slab_of(coordinate, root_min[axis], root_side_m, level);
}

Box part_inside(const Box& box, const DyadicGrid& grid, const CellKey& key) {
  const Box cube = grid.cube(key);
  const Box part = intersection(box, cube);
  if (part.empty()) return {};
  for (int axis = 0; axis < 3; ++axis) {
    if (part.min[axis] < part.max[axis]) continue;
    const bool touches_only = box.min[axis] < box.max[axis];
    const bool last = key.index[static_cast<std::size_t>(axis)] + 1 == 1 << key.level;
    if (touches_only || (part.min[axis] == cube.max[axis] && !last)) return {};
  }
  return part;
}

Box ViewSpace::bounds() const {
  Box all;
  for (const Box& box : boxes) all.extend(box);
  return all;
}

Box ViewSpace::cell_box(const CellKey& key) const {
  const Box cell_cube = cube(key);
  Box all;
  for (const Box& box : boxes) {
    if (box.min.x > cell_cube.max.x) break;
    all.extend(part_inside(box, grid(), key));
  }
  return all;
}

std::vector<double> volume_sums(const std::vector<Box>& boxes) {
  std::vector<double> sums;
  sums.reserve(boxes.size());
  double sum = 0.0;
  for (const Box& box : boxes) sums.push_back(sum += volume(box));
  return sums;
}

Vec3 sample_boxes(const std::vector<Box>& boxes, const std::vector<double>& volume_sum, Rng& rng) {
  const double target = rng.uniform() * volume_sum.back();
  const auto chosen = std::upper_bound(volume_sum.begin(), volume_sum.end() - 1, target) - volume_sum.begin();
  const Box& box = boxes[static_cast<std::size_t>(chosen)];
  Vec3 position{0.0};
  for (int axis = 0; axis < 3; ++axis) position[axis] = std::clamp(rng.uniform(box.min[axis], box.max[axis]), box.min[axis], box.max[axis]);
  return position;
}

Vec3 ViewSpace::sample_position(Rng& rng) const {
  return sample_boxes(boxes, volume_sum, rng);
}

ViewSpaceKind default_view_space(const Scene& scene, std::string& why) {
  if (scene.objects.size() == 1) {
    why = "orbit: the scene is one object";
    return ViewSpaceKind::kOrbit;
  }
  const Vec3 size = scene.bounds.size();
  const std::string extents = number_text(size.x) + " x " + number_text(size.y) + " x " + number_text(size.z) + " m";
  if (is_exhibit(scene)) {
    why = "orbit: the scene's extents, " + extents + ", are within a factor of 3 of each other";
    return ViewSpaceKind::kOrbit;
  }
  why = "walk: the scene's extents, " + extents + ", differ by more than a factor of 3";
  return ViewSpaceKind::kWalk;
}

ViewSpace finish_view_space(ViewSpaceKind kind, std::string why, std::vector<Box> boxes, const ViewSpaceOptions& options) {
  check_options(options);
  if (boxes.empty()) throw Failure(ErrorWord::kViewSpaceEmpty, "view space: no position to stand at (" + why + ")");
  for (const Box& box : boxes) check_box(box);
  const auto key = [](const Box& b) { return std::tuple(b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z); };
  std::sort(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { return key(a) < key(b); });
  boxes.erase(std::unique(boxes.begin(), boxes.end()), boxes.end());

  ViewSpace space;
  space.kind = kind;
  space.why = std::move(why);
  space.volume_sum = volume_sums(boxes);
  space.boxes = std::move(boxes);
  double leaf_m = options.leaf_m;
  lay_grid(space, leaf_m, options.refine_levels);
  while (has_more_leaves_than(space, options.max_leaves)) lay_grid(space, leaf_m *= 2.0, options.refine_levels);
  if (leaf_m > options.leaf_m)
    space.left_out.push_back("leaves of " + number_text(leaf_m) + " m instead of " + number_text(options.leaf_m) + " m: more than " +
                             std::to_string(options.max_leaves) + " otherwise");
  return space;
}

ViewSpace make_path_view_space(const std::vector<Vec3>& positions, double radius_m, const ViewSpaceOptions& options) {
  require(std::isfinite(radius_m) && radius_m >= 0.0, "path: radius " + number_text(radius_m) + " m must be finite and not negative");
  std::vector<Box> boxes;
  boxes.reserve(positions.size());
  for (const Vec3& position : positions) boxes.push_back({position - radius_m, position + radius_m});
  return finish_view_space(ViewSpaceKind::kPath, "path: " + std::to_string(positions.size()) + " positions", std::move(boxes), options);
}

ViewSpace make_box_view_space(std::vector<Box> boxes, const ViewSpaceOptions& options) {
  std::string why = "boxes: " + std::to_string(boxes.size()) + " given";
  return finish_view_space(ViewSpaceKind::kBoxes, std::move(why), std::move(boxes), options);
}

}  // namespace standin
