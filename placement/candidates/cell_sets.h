// Which sets of cells a cluster's candidates may serve (thesis 5.6).
//
// Shafts: a pyramid about the cluster's centre in one of the grid's directions, with one of the apex angles, holds some leaf cubes of the
// view space; minimum distances of 1, 2, 4 .. box diagonals give nested subsets, the far ones. We go from the cubes to the directions that
// can hold them, so the blind product of directions and distances is never formed. Cells finer than a leaf are gathered cube by cube:
// pyramids see leaves alone, or a city's halved cells would be asked for in millions of combinations. Boxes: the cells below each node of
// the view space's dyadic grid.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/candidates/candidates.h"

namespace standin {

using CellSet = std::vector<std::uint32_t>;  // ascending

/// Directions (azimuth, elevation) in steps of an angle, both poles included. `every_direction`: append_near gives all of them, as the
/// blind product would; what holds a cell is the same.
class DirectionGrid {
 public:
  explicit DirectionGrid(double step_deg, bool every_direction = false);

  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  /// Frame of one direction: axis, right, up; apex and aperture are left open.
  [[nodiscard]] const Shaft& frame(std::uint32_t direction) const { return frames_[direction]; }
  /// Appends all directions within `angle_rad` of a unit vector (and a few more).
  void append_near(const Vec3& unit, double angle_rad, std::vector<std::uint32_t>& directions) const;

 private:
  bool every_direction_ = false;
  int rows_ = 0;     // elevations from -90 to 90 degrees
  int columns_ = 0;  // azimuths
  std::vector<Shaft> frames_;
};

/// Cells that pyramids hold together.
struct CellGroup {
  Box box;  // of all cells
  CellSet cells;
};
/// `cells` (ascending) by their ancestors of one level, in the order of these.
[[nodiscard]] std::vector<CellGroup> group_cells(std::span<const std::uint32_t> cells, const Subdivision& subdivision, int level);

using GroupSet = std::vector<std::uint32_t>;  // ascending

/// Every set of two or more groups that one pyramid holds; may repeat. `cluster`: bounds of the node.
[[nodiscard]] std::vector<GroupSet> shaft_group_sets(const Box& cluster, std::span<const CellGroup> groups, const DirectionGrid& grid,
                                                     std::span<const double> apex_deg);
/// A pyramid and all groups that it holds.
struct Pyramid {
  Shaft shaft;
  GroupSet groups;
};
/// Untightened: minimum distances are 1, 2, 4 .. 1024 diagonals of the cluster. Of those that hold the same groups the narrowest that
/// begins farthest, once.
[[nodiscard]] std::vector<Pyramid> pyramids(const Box& cluster, std::span<const CellGroup> groups, const DirectionGrid& grid,
                                            std::span<const double> apex_deg);
[[nodiscard]] CellSet cells_of(const GroupSet& set, std::span<const CellGroup> groups);

/// Every set of two or more of `cells` (ascending) below a node of the dyadic grid, from `coarsest_level` down; may repeat.
[[nodiscard]] std::vector<CellSet> box_cell_sets(std::span<const std::uint32_t> cells, const Subdivision& subdivision,
                                                 int coarsest_level = 0);

}  // namespace standin
