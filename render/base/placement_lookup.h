// Which part of a placement a view uses: the question that a renderer asks each frame, answered without allocation, files or other headers,
// so that an engine can take this one file along. The program itself finds cells and intervals by it when it plans and when it verifies.
//
// An engine reads placement.json once into arrays of LookupCell, LookupInterval and LookupCpv, in the file's order, lays a PlacementView
// over them and calls find_cell() for each view. Ids are indices into these arrays. What is then to be drawn: the impostors of the CPV, and
// of all other objects in the cell's `visible_objects` (all, when null) the originals, each in the level that level_shown() names.
//
// The rule (thesis 5.5): cells are half-open at the upper end, the last one closed. Of the leaf cells whose closed box holds the position,
// it is the one in whose cube the position is not on the upper border in x, if there is one; then likewise in y, then in z. A cube's box
// may end before the cube does, so a position can lie in a cube and in no cell. A direction's face is that of its largest component, ties x
// before y before z; its two angles on the face lie in half-open intervals, the last one closed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>

namespace standin {

using LookupVector = std::array<double, 3>;

/// placement.json `cells[i]`.
struct LookupCell {
  int level = 0;
  std::array<int, 3> index{};
  LookupVector min{}, max{};
};

/// placement.json `intervals[i]`. `face`: 0 to 5 for +x, -x, +y, -y, +z, -z.
struct LookupInterval {
  int face = 0;
  int level = 0;
  std::array<int, 2> index{};
  friend auto operator<=>(const LookupInterval&, const LookupInterval&) = default;
};

/// placement.json `cpvs[i]`.
struct LookupCpv {
  std::uint32_t cell = 0;
  std::uint32_t interval = 0;
  friend auto operator<=>(const LookupCpv&, const LookupCpv&) = default;
};

/// What a view uses.
struct Lookup {
  std::optional<std::uint32_t> cell;  // none: outside the view space, all originals are drawn
  std::optional<std::uint32_t> cpv;   // none: no impostors
};

/// A placement's arrays, which must outlive it. Cells ascend by (level, index), intervals by (face, level, index), CPVs by (cell,
/// interval), as the file has them; no cell is an ancestor of another.
struct PlacementView {
  LookupVector root_min{};   // view_space.root.min
  double root_side_m = 0.0;  // view_space.root.side
  std::span<const LookupCell> cells;
  std::span<const LookupInterval> intervals;
  std::span<const LookupCpv> cpvs;
  std::uint32_t interval_levels = 0;  // bit l: some interval has level l (levels_in_use)
};

/// Directions have no intervals below this level.
inline constexpr int kDeepestIntervalLevel = 20;

/// The bits of PlacementView::interval_levels.
[[nodiscard]] inline std::uint32_t levels_in_use(std::span<const LookupInterval> intervals) {
  std::uint32_t levels = 0;
  for (const LookupInterval& interval : intervals) levels |= std::uint32_t{1} << interval.level;
  return levels;
}

/// Lower border of slab `index` of a dyadic grid. `side_m` of a slab: halving is exact, so the levels agree on common borders to the last
/// bit.
[[nodiscard]] inline double slab_border(double root_min, double side_m, int index) {
  return root_min + side_m * index;
}

/// The half-open slab of `level` that holds `coordinate`; -1 or 2^level beyond the root.
[[nodiscard]] inline int slab_of(double coordinate, double root_min, double root_side_m, int level) {
  const double side_m = std::ldexp(root_side_m, -level);
  const int count = 1 << level;
  if (!(coordinate >= root_min)) return -1;
  if (coordinate >= slab_border(root_min, side_m, count)) return count;
  int index = std::clamp(static_cast<int>((coordinate - root_min) / side_m), 0, count - 1);
  while (coordinate < slab_border(root_min, side_m, index)) --index;
  while (coordinate >= slab_border(root_min, side_m, index + 1)) ++index;
  return index;
}

/// Lower border of angle interval `index`. The fraction is exact in binary: the levels agree on common borders to the last bit.
[[nodiscard]] inline double angle_border_rad(int index, int level) {
  constexpr double kEighthTurn = 0.78539816339744830962;
  return kEighthTurn * (std::ldexp(static_cast<double>(index), 1 - level) - 1.0);
}

/// The half-open angle interval of `level` that holds `angle_rad`, which is in [-pi/4, pi/4]; the last one is closed.
[[nodiscard]] inline int angle_slot(double angle_rad, int level) {
  constexpr double kEighthTurn = 0.78539816339744830962;
  const int count = 1 << level;
  const int index = std::clamp(static_cast<int>(std::floor((angle_rad / kEighthTurn + 1.0) * 0.5 * count)), 0, count - 1);
  if (index + 1 < count && angle_rad >= angle_border_rad(index + 1, level)) return index + 1;
  if (index > 0 && angle_rad < angle_border_rad(index, level)) return index - 1;
  return index;
}

/// Where a direction meets the direction cube: d ~ n + tan(a) u + tan(b) v, with placement.json's `faces`.
struct FaceAngles {
  int face = 0;
  double a_rad = 0.0, b_rad = 0.0;
};

/// None for a direction without length or with a component that is no number.
[[nodiscard]] inline std::optional<FaceAngles> face_angles(const LookupVector& d) {
  const double x = std::abs(d[0]), y = std::abs(d[1]), z = std::abs(d[2]);
  if (x >= y && x >= z && x > 0.0) {
    if (d[0] > 0.0) return FaceAngles{0, std::atan2(-d[2], x), std::atan2(d[1], x)};
    return FaceAngles{1, std::atan2(d[2], x), std::atan2(d[1], x)};
  }
  if (y >= z && y > 0.0) {
    if (d[1] > 0.0) return FaceAngles{2, std::atan2(d[0], y), std::atan2(-d[2], y)};
    return FaceAngles{3, std::atan2(d[0], y), std::atan2(d[2], y)};
  }
  if (!(z > 0.0)) return std::nullopt;
  if (d[2] > 0.0) return FaceAngles{4, std::atan2(d[0], z), std::atan2(d[1], z)};
  return FaceAngles{5, std::atan2(-d[0], z), std::atan2(d[1], z)};
}

/// The cell whose cube is slab (index) of `level`, if it is a leaf.
[[nodiscard]] inline std::optional<std::uint32_t> cell_at(std::span<const LookupCell> cells, int level, const std::array<int, 3>& index) {
  const auto key = std::tie(level, index);
  const auto found = std::lower_bound(cells.begin(), cells.end(), key,
                                      [](const LookupCell& cell, const auto& wanted) { return std::tie(cell.level, cell.index) < wanted; });
  if (found == cells.end() || found->level != level || found->index != index) return std::nullopt;
  return static_cast<std::uint32_t>(found - cells.begin());
}

/// Whether the closed box of a cell holds the position.
[[nodiscard]] inline bool box_holds(const LookupCell& cell, const LookupVector& position) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(cell.min[axis] <= position[axis] && position[axis] <= cell.max[axis])) return false;
  return true;
}

/// The leaf that holds the position and, of the finest level, slab (index).
[[nodiscard]] inline std::optional<std::uint32_t> leaf_above(std::span<const LookupCell> cells, const std::array<int, 3>& index,
                                                             const LookupVector& position) {
  const int finest = cells.back().level;
  for (int level = finest; level >= cells.front().level; --level) {
    const int shift = finest - level;
    const auto id = cell_at(cells, level, {index[0] >> shift, index[1] >> shift, index[2] >> shift});
    if (id && box_holds(cells[*id], position)) return id;
  }
  return std::nullopt;
}

/// The cell that holds a position.
[[nodiscard]] inline std::optional<std::uint32_t> find_cell(const PlacementView& placement, const LookupVector& position) {
  if (placement.cells.empty()) return std::nullopt;
  const int finest = placement.cells.back().level;
  const double side_m = std::ldexp(placement.root_side_m, -finest);
  std::array<int, 3> index{};
  int on_borders = 0;  // bit 2, 1, 0 for x, y, z: then the slab below is closed there and may hold the position too
  for (std::size_t axis = 0; axis < 3; ++axis) {
    index[axis] = slab_of(position[axis], placement.root_min[axis], placement.root_side_m, finest);
    if (index[axis] < 0) return std::nullopt;
    const bool on_border = position[axis] == slab_border(placement.root_min[axis], side_m, index[axis]);
    on_borders |= on_border && index[axis] > 0 ? 4 >> axis : 0;
  }
  // Eight ways to step down across borders; those that do not in x come first, of these those that do not in y.
  for (int down = 0; down < 8; ++down) {
    if ((down & on_borders) != down) continue;
    const std::array<int, 3> stepped = {index[0] - (down >> 2), index[1] - (down >> 1 & 1), index[2] - (down & 1)};
    if (const auto found = leaf_above(placement.cells, stepped, position)) return found;
  }
  return std::nullopt;
}

/// The CPV of a cell that holds a direction, whose length does not matter.
[[nodiscard]] inline std::optional<std::uint32_t> find_cpv(const PlacementView& placement, std::uint32_t cell,
                                                           const LookupVector& direction) {
  const auto first = std::lower_bound(placement.cpvs.begin(), placement.cpvs.end(), LookupCpv{cell, 0});
  if (first == placement.cpvs.end() || first->cell != cell) return std::nullopt;
  const auto angles = face_angles(direction);
  if (!angles) return std::nullopt;
  for (int level = kDeepestIntervalLevel; level >= 0; --level) {
    if ((placement.interval_levels >> level & 1) == 0) continue;
    const LookupInterval wanted{angles->face, level, {angle_slot(angles->a_rad, level), angle_slot(angles->b_rad, level)}};
    const auto interval = std::lower_bound(placement.intervals.begin(), placement.intervals.end(), wanted);
    if (interval == placement.intervals.end() || *interval != wanted) continue;
    const auto id = static_cast<std::uint32_t>(interval - placement.intervals.begin());
    const LookupCpv sought{cell, id};
    const auto cpv = std::lower_bound(first, placement.cpvs.end(), sought);
    if (cpv != placement.cpvs.end() && *cpv == sought) return static_cast<std::uint32_t>(cpv - placement.cpvs.begin());
  }
  return std::nullopt;
}

/// Cell and CPV of a view.
[[nodiscard]] inline Lookup find_cell(const PlacementView& placement, const LookupVector& position, const LookupVector& direction) {
  Lookup lookup{find_cell(placement, position), std::nullopt};
  if (lookup.cell) lookup.cpv = find_cpv(placement, *lookup.cell, direction);
  return lookup;
}

/// Level of detail in which views from a cell show an object with these bounds (`scene.objects[i].bounds`): 0 its own parts, else entry
/// level - 1 of its `lods.objects[].levels`, whose `least_distance` ascend. Views outside all cells show level 0.
[[nodiscard]] inline std::size_t level_shown(const LookupVector& cell_min, const LookupVector& cell_max, const LookupVector& object_min,
                                             const LookupVector& object_max, std::span<const double> least_distance_m) {
  double square = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double gap = std::max(std::max(cell_min[axis] - object_max[axis], object_min[axis] - cell_max[axis]), 0.0);
    square += gap * gap;
  }
  return static_cast<std::size_t>(std::upper_bound(least_distance_m.begin(), least_distance_m.end(), std::sqrt(square)) -
                                  least_distance_m.begin());
}

}  // namespace standin
