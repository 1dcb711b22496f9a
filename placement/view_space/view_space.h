// The view space: where an eye may be, as a list of boxes, and its dyadic subdivision into cells.
//
// Boxes are the definition: every view whose position lies in one of them (and any direction) must meet the budget. Cells are cubes of a
// dyadic grid, clipped to the tight bounds of the boxes inside them, so a checker that knows the root gets every ancestor back from (level,
// index).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "render/base/rng.h"
#include "render/scene/scene.h"
#include "render/view/camera.h"
#include "render/visibility/raytracer.h"

namespace standin {

enum class ViewSpaceKind { kWalk, kOrbit, kPath, kBoxes };

struct ViewSpaceOptions {
  double leaf_m = 23.0;         // side of a 3D leaf (thesis 5.8.1)
  int refine_levels = 2;        // hot leaves are halved so often in position (23 -> 5.75 m)
  double interval_deg = 11.25;  // width of a direction leaf
  double eye_height_m = 1.7;    // walk
  double orbit_near = 2.5;      // orbit shell, in bounding radii
  double orbit_far = 10.0;
  std::uint64_t max_leaves = 20'000;  // 3D leaves grow (doubled) until fewer; reported
};

/// Node of the dyadic grid; cube (i, j, k) of 2^level a side.
struct CellKey {
  int level = 0;
  std::array<int, 3> index{};
  [[nodiscard]] CellKey parent() const { return {level - 1, {index[0] >> 1, index[1] >> 1, index[2] >> 1}}; }
  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

struct ViewSpace {
  ViewSpaceKind kind = ViewSpaceKind::kBoxes;
  std::string why;         // why this kind was chosen, one sentence
  std::vector<Box> boxes;  // sorted by (min.x, min.y, min.z); may have zero thickness
  Vec3 root_min{0.0};      // of the dyadic grid
  double root_side_m = 0.0;
  int leaf_level = 0;
  int finest_level = 0;
  std::vector<std::string> left_out;  // e.g. "leaves of 46 m instead of 23 m: more than 20000 otherwise"

  [[nodiscard]] Box bounds() const;
  [[nodiscard]] Box cube(const CellKey& key) const;
  /// Tight bounds of the boxes' parts inside the cube; empty when there are none.
  [[nodiscard]] Box cell_box(const CellKey& key) const;
  /// Uniform over the boxes (by volume; zero-thickness axes do not count).
  [[nodiscard]] Vec3 sample_position(Rng& rng) const;
};

/// orbit for one object, or extents within a factor of 3 of each other; else walk (architecture.md).
[[nodiscard]] ViewSpaceKind default_view_space(const Scene& scene, std::string& why);
/// Eye `eye_height_m` above the highest surface that faces up and has free sky above, clear of objects. Throws Failure(kViewSpaceEmpty).
[[nodiscard]] ViewSpace make_walk_view_space(const Scene& scene, const Raytracer& raytracer, const ViewSpaceOptions& options);
[[nodiscard]] ViewSpace make_orbit_view_space(const Scene& scene, const ViewSpaceOptions& options);
/// `positions` (the points of a path file), each with a box of `radius_m` around it.
[[nodiscard]] ViewSpace make_path_view_space(const std::vector<Vec3>& positions, double radius_m, const ViewSpaceOptions& options);
[[nodiscard]] ViewSpace make_box_view_space(std::vector<Box> boxes, const ViewSpaceOptions& options);

}  // namespace standin
