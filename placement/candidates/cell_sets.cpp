#include "placement/candidates/cell_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// A group that lies in a pyramid of the grid.
struct Held {
  std::uint32_t pyramid = 0;  // direction * apex count + apex
  double near_m = 0.0;        // least distance of the group along the axis
  std::uint32_t group = 0;
};

/// What a group needs of a pyramid about `apex` with the axes of `frame`.
struct Need {
  double tan_half = 0.0;
  double near_m = std::numeric_limits<double>::infinity();
};

Need need_of(const Box& box, const Vec3& apex, const Shaft& frame) {
  Need need;
  for (int i = 0; i < 8; ++i) {
    const Vec3 from_apex = box.corner(i) - apex;
    const double along_m = glm::dot(from_apex, frame.axis);
    if (along_m <= 0.0) return {std::numeric_limits<double>::infinity(), 0.0};
    const double aside_m = std::max(std::abs(glm::dot(from_apex, frame.right)), std::abs(glm::dot(from_apex, frame.up)));
    need.tan_half = std::max(need.tan_half, aside_m / along_m);
    need.near_m = std::min(need.near_m, along_m);
  }
  return need;
}

/// Far groups first within each pyramid.
std::vector<Held> held_groups(const Vec3& apex, std::span<const CellGroup> groups, const DirectionGrid& grid,
                              std::span<const double> tan_half) {
  const double widest = *std::max_element(tan_half.begin(), tan_half.end());
  const double reach_rad = std::atan(std::numbers::sqrt2 * widest);  // from the axis to the pyramid's edge
  std::vector<Held> held;
  std::vector<std::uint32_t> directions;
  for (std::uint32_t group = 0; group < groups.size(); ++group) {
    const Box& box = groups[group].box;
    const Vec3 towards = box.centre() - apex;
    const double distance_m = glm::length(towards);
    if (distance_m <= 0.0) continue;
    directions.clear();
    grid.append_near(towards / distance_m, reach_rad, directions);
    for (const std::uint32_t direction : directions) {
      const Need need = need_of(box, apex, grid.frame(direction));
      for (std::uint32_t a = 0; a < tan_half.size(); ++a)
        if (need.tan_half <= tan_half[a]) held.push_back({direction * static_cast<std::uint32_t>(tan_half.size()) + a, need.near_m, group});
    }
  }
  std::sort(held.begin(), held.end(), [](const Held& a, const Held& b) {
    if (a.pyramid != b.pyramid) return a.pyramid < b.pyramid;
    return a.near_m != b.near_m ? a.near_m > b.near_m : a.group < b.group;
  });
  return held;
}

GroupSet groups_of(std::span<const Held> held) {
  GroupSet set;
  for (const Held& h : held) set.push_back(h.group);
  std::sort(set.begin(), set.end());
  return set;
}

/// Calls visit(held, octave) for all groups of one pyramid, then for those beyond each doubling of `unit_m`; all lie beyond
/// unit_m * 2^octave.
template <class Visit>
void for_each_nested(std::span<const Held> held, double unit_m, Visit&& visit) {
  while (!held.empty()) {
    const double octave = std::floor(std::log2(held.back().near_m / unit_m));
    visit(held, octave);
    const double least_m = unit_m * std::exp2(octave + 1.0);
    auto beyond = held.size();
    while (beyond > 0 && held[beyond - 1].near_m < least_m) --beyond;
    if (beyond == held.size()) return;  // rounding left nothing to drop
    held = held.first(beyond);
  }
}

/// Calls visit(held) for the groups of each pyramid that holds any.
template <class Visit>
void for_each_pyramid(std::span<const Held> held, Visit&& visit) {
  for (std::size_t begin = 0; begin < held.size();) {
    std::size_t end = begin;
    while (end < held.size() && held[end].pyramid == held[begin].pyramid) ++end;
    visit(held.subspan(begin, end - begin));
    begin = end;
  }
}

std::vector<double> tangents_of_halves(std::span<const double> apex_deg) {
  std::vector<double> tan_half;
  for (const double apex : apex_deg) tan_half.push_back(std::tan(0.5 * apex * kRadPerDeg));
  return tan_half;
}

double unit_of(const Box& cluster) {
  return std::max(cluster.diagonal(), 1e-6);
}

}  // namespace

DirectionGrid::DirectionGrid(double step_deg, bool every_direction) : every_direction_(every_direction) {
  if (!(step_deg >= 1.0 && step_deg <= 90.0))
    throw Failure(ErrorWord::kBadUsage, "direction_step_deg = " + std::to_string(step_deg) + " violates 1 <= direction_step_deg <= 90");
  rows_ = static_cast<int>(std::lround(180.0 / step_deg)) + 1;
  columns_ = static_cast<int>(std::lround(360.0 / step_deg));
  for (int row = 0; row < rows_; ++row) {
    const double elevation = std::numbers::pi * (static_cast<double>(row) / (rows_ - 1) - 0.5);
    for (int column = 0; column < columns_; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * column / columns_;
      const Vec3 axis(std::cos(elevation) * std::cos(azimuth), std::sin(elevation), std::cos(elevation) * std::sin(azimuth));
      frames_.push_back(shaft_frame(Vec3(0.0), axis));
    }
  }
}

void DirectionGrid::append_near(const Vec3& unit, double angle_rad, std::vector<std::uint32_t>& directions) const {
  if (every_direction_) angle_rad = std::numbers::pi;
  const double row_step = std::numbers::pi / (rows_ - 1);
  const double elevation = std::asin(std::clamp(unit.y, -1.0, 1.0));
  const int first_row = std::max(0, static_cast<int>(std::floor((elevation - angle_rad + 0.5 * std::numbers::pi) / row_step)));
  const int last_row = std::min(rows_ - 1, static_cast<int>(std::ceil((elevation + angle_rad + 0.5 * std::numbers::pi) / row_step)));

  // A cap that does not hold a pole spans asin(sin(angle) / cos(elevation)) in azimuth to either side.
  const double column_step = 2.0 * std::numbers::pi / columns_;
  int first_column = 0;
  int last_column = columns_ - 1;
  if (std::abs(elevation) + angle_rad < 0.5 * std::numbers::pi) {
    const double half_span = std::asin(std::min(1.0, std::sin(angle_rad) / std::cos(elevation)));
    const double azimuth = std::atan2(unit.z, unit.x);
    first_column = static_cast<int>(std::floor((azimuth - half_span) / column_step));
    last_column = std::min(static_cast<int>(std::ceil((azimuth + half_span) / column_step)), first_column + columns_ - 1);
  }
  for (int row = first_row; row <= last_row; ++row) {
    // All azimuths of a pole are one direction.
    const bool pole = row == 0 || row == rows_ - 1;
    for (int column = pole ? 0 : first_column; column <= (pole ? 0 : last_column); ++column)
      directions.push_back(static_cast<std::uint32_t>(row * columns_ + ((column % columns_) + columns_) % columns_));
  }
}

std::vector<CellGroup> group_cells(std::span<const std::uint32_t> cells, const Subdivision& subdivision, int level) {
  std::map<CellKey, CellGroup> below;
  for (const std::uint32_t cell : cells) {
    CellKey key = subdivision.cells[cell].key;
    while (key.level > level) key = key.parent();
    CellGroup& group = below[key];
    group.box.extend(subdivision.cells[cell].box);
    group.cells.push_back(cell);
  }
  std::vector<CellGroup> groups;
  for (auto& [key, group] : below) groups.push_back(std::move(group));
  return groups;
}

std::vector<GroupSet> shaft_group_sets(const Box& cluster, std::span<const CellGroup> groups, const DirectionGrid& grid,
                                       std::span<const double> apex_deg) {
  std::vector<GroupSet> sets;
  if (groups.size() < 2 || apex_deg.empty()) return sets;
  const auto held = held_groups(cluster.centre(), groups, grid, tangents_of_halves(apex_deg));
  for_each_pyramid(held, [&](std::span<const Held> of_pyramid) {
    for_each_nested(of_pyramid, unit_of(cluster), [&](std::span<const Held> nested, double) {
      if (nested.size() >= 2) sets.push_back(groups_of(nested));
    });
  });
  return sets;
}

std::vector<Pyramid> pyramids(const Box& cluster, std::span<const CellGroup> groups, const DirectionGrid& grid,
                              std::span<const double> apex_deg) {
  constexpr double kMostDoublings = 10.0;
  std::vector<Pyramid> all;
  if (groups.empty() || apex_deg.empty()) return all;
  const auto tan_half = tangents_of_halves(apex_deg);
  const auto held = held_groups(cluster.centre(), groups, grid, tan_half);
  for_each_pyramid(held, [&](std::span<const Held> of_pyramid) {
    Shaft shaft = grid.frame(of_pyramid.front().pyramid / static_cast<std::uint32_t>(tan_half.size()));
    shaft.apex = cluster.centre();
    shaft.tan_half = Vec2(tan_half[of_pyramid.front().pyramid % tan_half.size()]);
    for_each_nested(of_pyramid, unit_of(cluster), [&](std::span<const Held> nested, double octave) {
      if (octave < 0.0) return;
      shaft.min_distance_m = unit_of(cluster) * std::exp2(std::min(octave, kMostDoublings));
      all.push_back({shaft, groups_of(nested)});
    });
  });
  std::stable_sort(all.begin(), all.end(), [](const Pyramid& a, const Pyramid& b) {
    if (a.groups != b.groups) return a.groups < b.groups;
    if (a.shaft.tan_half.x != b.shaft.tan_half.x) return a.shaft.tan_half.x < b.shaft.tan_half.x;
    return a.shaft.min_distance_m > b.shaft.min_distance_m;
  });
  all.erase(std::unique(all.begin(), all.end(), [](const Pyramid& a, const Pyramid& b) { return a.groups == b.groups; }), all.end());
  return all;
}

CellSet cells_of(const GroupSet& set, std::span<const CellGroup> groups) {
  CellSet cells;
  for (const std::uint32_t group : set) cells.insert(cells.end(), groups[group].cells.begin(), groups[group].cells.end());
  std::sort(cells.begin(), cells.end());
  return cells;
}

std::vector<CellSet> box_cell_sets(std::span<const std::uint32_t> cells, const Subdivision& subdivision, int coarsest_level) {
  std::map<CellKey, CellSet> below;
  for (const std::uint32_t cell : cells) {
    CellKey key = subdivision.cells[cell].key;
    for (below[key].push_back(cell); key.level > coarsest_level;) below[key = key.parent()].push_back(cell);
  }
  std::vector<CellSet> sets;
  for (auto& [key, set] : below)
    if (set.size() >= 2) sets.push_back(std::move(set));
  return sets;
}

}  // namespace standin
