// The orbit view space: the shell between two distances from the scene's centre, as cubes of the leaf grid.
//
// Cubes that reach inside the inner sphere are halved and their parts beyond it dropped, so that cells keep off the scene.
#include <algorithm>
#include <cmath>
#include <limits>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/number_text.h"
#include "placement/view_space/view_space.h"
#include "render/base/error.h"

namespace standin {
namespace {

// Relative slack of distances, so that the cubes at the shell's six outermost points are not lost to rounding.
constexpr double kSlack = 1e-9;
constexpr int kHalvings = 2;

struct Shell {
  Vec3 centre{0.0};
  double near_m = 0.0;
  double far_m = 0.0;

  [[nodiscard]] double nearest(const Box& box) const { return distance(centre, box); }
  [[nodiscard]] double farthest(const Box& box) const {
    return glm::length(glm::max(glm::abs(box.min - centre), glm::abs(box.max - centre)));
  }
};

void add_parts(const Shell& shell, const DyadicGrid& grid, const CellKey& key, int halvings, std::vector<Box>& boxes) {
  const Box cube = grid.cube(key);
  if (shell.nearest(cube) > shell.far_m * (1.0 + kSlack) || shell.farthest(cube) < shell.near_m) return;
  if (shell.nearest(cube) >= shell.near_m || halvings == 0) {
    boxes.push_back(cube);
    return;
  }
  for (int c = 0; c < 8; ++c) add_parts(shell, grid, key.child(c), halvings - 1, boxes);
}

// A bound from above: the cubes in the ball that holds every cube touching the shell.
double most_leaves(const Shell& shell, double side_m) {
  const double radius = shell.far_m / side_m + std::sqrt(3.0);
  return 4.19 * radius * radius * radius;
}

// Doubled while there may be more leaves than allowed, up to `largest_m`: larger ones would reach into the scene.
double leaf_side(const Shell& shell, double wanted_m, double largest_m, std::uint64_t max_leaves) {
  double side_m = wanted_m;
  while (most_leaves(shell, side_m) > static_cast<double>(max_leaves) && side_m < largest_m) side_m = std::min(2.0 * side_m, largest_m);
  return side_m;
}

}  // namespace

ViewSpace make_orbit_view_space(const Scene& scene, const ViewSpaceOptions& options) {
  const double radius_m = 0.5 * scene.bounds.diagonal();
  if (!(radius_m > 0.0)) throw Failure(ErrorWord::kViewSpaceEmpty, "orbit: the scene has no extent (bounding radius 0)");
  if (!(options.orbit_near > 0.0 && options.orbit_near < options.orbit_far && std::isfinite(options.orbit_far)))
    throw Failure(ErrorWord::kBadUsage, "orbit: 0 < near < far is needed, not " + number_text(options.orbit_near) + " and " +
                                            number_text(options.orbit_far) + " bounding radii");
  const Shell shell{scene.bounds.centre(), options.orbit_near * radius_m, options.orbit_far * radius_m};
  const double wanted_m = std::min(options.leaf_m, radius_m);
  const double side_m = leaf_side(shell, wanted_m, radius_m, options.max_leaves);

  // One cube more than needed on the upper side when the division is inexact; the shell decides.
  const int level = static_cast<int>(std::ceil(std::log2(2.0 * shell.far_m / side_m) + 1e-9));
  const DyadicGrid grid{shell.centre - shell.far_m, std::ldexp(side_m, std::max(level, 0))};
  const int count = std::min(static_cast<int>(std::ceil(2.0 * shell.far_m / side_m * (1.0 + kSlack))), 1 << std::max(level, 0));
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < count; ++k) add_parts(shell, grid, {std::max(level, 0), {i, j, k}}, kHalvings, boxes);

  ViewSpaceOptions laid = options;
  laid.leaf_m = side_m;
  laid.max_leaves = std::numeric_limits<std::uint64_t>::max();  // settled above
  std::string why = "orbit: from " + number_text(shell.near_m) + " to " + number_text(shell.far_m) + " m around the scene's centre";
  if (wanted_m < options.leaf_m) why += ", leaves no larger than its bounding radius";
  ViewSpace space = finish_view_space(ViewSpaceKind::kOrbit, std::move(why), std::move(boxes), laid);
  if (side_m > wanted_m)
    space.left_out.insert(space.left_out.begin(), "leaves of " + number_text(side_m) + " m instead of " + number_text(wanted_m) +
                                                      " m: more than " + std::to_string(options.max_leaves) + " otherwise");
  const std::size_t leaves = CellBoxes(space).leaves().size();
  if (leaves > options.max_leaves)
    space.left_out.push_back("no limit of " + std::to_string(options.max_leaves) + " leaves: there are " + std::to_string(leaves) +
                             ", since leaves larger than the bounding radius would reach into the scene");
  return space;
}

}  // namespace standin
