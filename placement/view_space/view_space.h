// The view space: where an eye may be, as a list of boxes, and its dyadic subdivision into cells (thesis 5.5.1).
//
// Boxes are the definition: every view whose position lies in one of them (and any direction) must meet the budget. Cells are cubes of a
// dyadic grid, clipped to the tight bounds of the boxes inside them, so a checker that knows the root gets every ancestor back from (level,
// index). The root starts at the least corner of all boxes and its side is leaf * 2^leaf_level.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/rng.h"
#include "render/base/work.h"
#include "render/scene/scene.h"
#include "render/visibility/raytracer.h"

namespace standin {

enum class ViewSpaceKind { kWalk, kOrbit, kPath, kBoxes };

/// What a region's bound looks at of each object that its views may see (region_bound.h).
enum class RegionBounds {
  kBySample,  // those of its surface samples that some view may see
  kByObject,  // all of it, as in the thesis
  kByView,    // what it costs in single views that are sampled: no bound (region_sample.h)
};

struct ViewSpaceOptions {
  double leaf_m = 23.0;         // side of a 3D leaf (thesis 5.8.1)
  int refine_levels = 3;        // hot leaves are halved so often in position (23 -> 2.875 m)
  double interval_deg = 11.25;  // width of a direction leaf in a leaf cube; halved with its first and third halving
  double eye_height_m = 1.7;    // walk
  double orbit_near = 2.5;      // orbit shell, in bounding radii
  double orbit_far = 10.0;
  std::uint64_t max_leaves = 20'000;  // 3D leaves grow (doubled) until fewer; reported
  RegionBounds bounds = RegionBounds::kBySample;
};

/// Node of the dyadic grid; cube (i, j, k) of 2^level a side.
struct CellKey {
  int level = 0;
  std::array<int, 3> index{};
  [[nodiscard]] CellKey parent() const { return {level - 1, {index[0] >> 1, index[1] >> 1, index[2] >> 1}}; }
  /// Child c in 0..7: bit 0, 1, 2 choose the upper half in x, y, z.
  [[nodiscard]] CellKey child(int c) const {
    return {level + 1, {2 * index[0] + (c & 1), 2 * index[1] + ((c >> 1) & 1), 2 * index[2] + (c >> 2)}};
  }
  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

/// A dyadic grid: cubes of one level share their borders to the last bit, and so do those of all levels.
struct DyadicGrid {
  Vec3 root_min{0.0};
  double root_side_m = 0.0;

  [[nodiscard]] Box cube(const CellKey& key) const;
  /// Index on `axis` of the half-open slab of `level` that holds `coordinate`; -1 or 2^level beyond the root.
  [[nodiscard]] int index_at(double coordinate, int axis, int level) const;
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
  std::vector<double> volume_sum;     // running sums of the boxes' volumes, for sample_position

  [[nodiscard]] DyadicGrid grid() const { return {root_min, root_side_m}; }
  [[nodiscard]] Box bounds() const;
  [[nodiscard]] Box cube(const CellKey& key) const { return grid().cube(key); }
  /// Tight bounds of the boxes' parts inside the cube; empty when there are none. Scans the boxes: see CellBoxes for many cells.
  [[nodiscard]] Box cell_box(const CellKey& key) const;
  /// Uniform over the boxes (by volume; zero-thickness axes do not count).
  [[nodiscard]] Vec3 sample_position(Rng& rng) const;
};

/// The part of `box` that belongs to the cube of `key`; empty when there is none. Cubes are half-open at the upper end, the last one
/// closed: a box that only touches a cube from outside has no part in it, and a box of zero thickness on a border belongs to the upper
/// cube.
[[nodiscard]] Box part_inside(const Box& box, const DyadicGrid& grid, const CellKey& key);

/// Uniform over `boxes`, whose volumes have the running sums `volume_sum`.
[[nodiscard]] Vec3 sample_boxes(const std::vector<Box>& boxes, const std::vector<double>& volume_sum, Rng& rng);
/// Running sums of volumes; axes of zero thickness count as factor 1.
[[nodiscard]] std::vector<double> volume_sums(const std::vector<Box>& boxes);

/// orbit for one object, or extents within a factor of 3 of each other; else walk (architecture.md).
[[nodiscard]] ViewSpaceKind default_view_space(const Scene& scene, std::string& why);
/// Eye `eye_height_m` above the ground, clear of objects; walk.cpp says what ground is. Throws Failure(kViewSpaceEmpty).
[[nodiscard]] ViewSpace make_walk_view_space(const Scene& scene, const Raytracer& raytracer, const ViewSpaceOptions& options,
                                             int threads = 1, const WorkBudget& budget = {});
/// The shell from `orbit_near` to `orbit_far` bounding radii about the scene's centre. Leaves are no larger than one radius, so that a cell
/// at the inner border stays outside the scene.
[[nodiscard]] ViewSpace make_orbit_view_space(const Scene& scene, const ViewSpaceOptions& options);
/// `positions` (the points of a path file), each with a box of `radius_m` around it.
[[nodiscard]] ViewSpace make_path_view_space(const std::vector<Vec3>& positions, double radius_m, const ViewSpaceOptions& options);
[[nodiscard]] ViewSpace make_box_view_space(std::vector<Box> boxes, const ViewSpaceOptions& options);

/// Sorts the boxes and lays the dyadic grid over them; what all makers end with. Throws Failure(kViewSpaceEmpty, kBadUsage).
[[nodiscard]] ViewSpace finish_view_space(ViewSpaceKind kind, std::string why, std::vector<Box> boxes, const ViewSpaceOptions& options);

}  // namespace standin
