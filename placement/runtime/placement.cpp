#include "placement/runtime/placement.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "render/base/error.h"
#include "render/scene/level_file.h"

namespace standin {
namespace {

void require(bool holds, const std::string& what, std::size_t number, const std::string& fault) {
  if (!holds) throw Failure(ErrorWord::kFileBroken, "placement: " + what + " " + std::to_string(number) + " " + fault);
}

CellLocator locate_cells(const Placement& placement) {
  std::vector<CellKey> keys;
  std::vector<Box> boxes;
  for (const PlacementCell& cell : placement.cells) {
    keys.push_back(cell.key);
    boxes.push_back(cell.box);
  }
  return {{placement.root_min, placement.root_side_m}, std::move(keys), std::move(boxes)};
}

void check_cpvs(const Placement& placement) {
  std::pair<std::uint32_t, std::uint32_t> previous{};
  for (std::size_t i = 0; i < placement.cpvs.size(); ++i) {
    const PlacementCpv& cpv = placement.cpvs[i];
    require(cpv.cell < placement.cells.size(), "problem view", i, "names cell " + std::to_string(cpv.cell) + ", which does not exist");
    require(cpv.interval < placement.intervals.size(), "problem view", i,
            "names interval " + std::to_string(cpv.interval) + ", which does not exist");
    for (const std::uint32_t impostor : cpv.impostors)
      require(impostor < placement.impostors.size(), "problem view", i,
              "names impostor " + std::to_string(impostor) + ", which does not exist");
    const std::pair key{cpv.cell, cpv.interval};
    require(i == 0 || previous < key, "problem view", i, "does not follow its predecessor in (cell, interval)");
    previous = key;
  }
}

std::vector<std::uint32_t> without(const std::vector<std::uint32_t>& objects, const std::vector<std::uint32_t>& replaced) {
  std::vector<std::uint32_t> rest;
  std::set_difference(objects.begin(), objects.end(), replaced.begin(), replaced.end(), std::back_inserter(rest));
  return rest;
}

// Both lists ascend. A view outside all cells shows what the scene holds.
std::vector<std::uint8_t> levels_of(const Placement& placement, const Lookup& lookup, const std::vector<std::uint32_t>& objects) {
  if (!lookup.cell || placement.levels.empty()) return {};
  const Box& cell = placement.cells[*lookup.cell].box;
  std::vector<std::uint8_t> levels;
  auto known = placement.levels.begin();
  for (const std::uint32_t object : objects) {
    while (known != placement.levels.end() && known->object < object) ++known;
    const bool has_levels = known != placement.levels.end() && known->object == object;
    levels.push_back(has_levels ? known->level_from(cell) : std::uint8_t{0});
  }
  return levels;
}

}  // namespace

std::uint8_t PlacementLevels::level_from(const Box& cell) const {
  const double distance_m = distance(cell, bounds);
  return static_cast<std::uint8_t>(std::ranges::upper_bound(least_distance_m, distance_m) - least_distance_m.begin());
}

std::vector<PlacementLevels> placement_levels(const Scene& scene) {
  std::vector<PlacementLevels> all;
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id) {
    const Object& object = scene.objects[id];
    if (object.levels.empty()) continue;
    all.push_back({id, object.bounds, {}, level_transform(scene, object)});
    for (const ObjectLevel& level : object.levels) all.back().least_distance_m.push_back(level.least_distance_m);
  }
  return all;
}

PlacementIndex::PlacementIndex(const Placement& placement) : placement_(&placement), cells_(locate_cells(placement)) {
  for (std::size_t i = 0; i < placement.intervals.size(); ++i) {
    require(i == 0 || placement.intervals[i - 1] < placement.intervals[i], "interval", i, "does not follow its predecessor");
    interval_levels_.push_back(placement.intervals[i].level);
  }
  std::sort(interval_levels_.rbegin(), interval_levels_.rend());
  interval_levels_.erase(std::unique(interval_levels_.begin(), interval_levels_.end()), interval_levels_.end());
  check_cpvs(placement);
  cpv_offset_.assign(placement.cells.size() + 1, 0);
  for (const PlacementCpv& cpv : placement.cpvs) {
    ++cpv_offset_[cpv.cell + 1];
    cpv_interval_.push_back(cpv.interval);
  }
  std::partial_sum(cpv_offset_.begin(), cpv_offset_.end(), cpv_offset_.begin());
}

Lookup PlacementIndex::find(const Vec3& position, const Vec3& direction) const {
  Lookup lookup;
  lookup.cell = cells_.find(position);
  if (!lookup.cell) return lookup;
  const auto first = cpv_interval_.begin() + cpv_offset_[*lookup.cell];
  const auto last = cpv_interval_.begin() + cpv_offset_[*lookup.cell + 1];
  if (first == last) return lookup;
  const auto& intervals = placement_->intervals;
  for (const int level : interval_levels_) {
    const DirectionInterval wanted = interval_of(direction, level);
    const auto interval = std::lower_bound(intervals.begin(), intervals.end(), wanted);
    if (interval == intervals.end() || *interval != wanted) continue;
    const auto id = static_cast<std::uint32_t>(interval - intervals.begin());
    const auto cpv = std::lower_bound(first, last, id);
    if (cpv == last || *cpv != id) continue;
    lookup.cpv = static_cast<std::uint32_t>(cpv - cpv_interval_.begin());
    return lookup;
  }
  return lookup;
}

ViewContent content_of(const Placement& placement, const Lookup& lookup, std::uint32_t object_count) {
  ViewContent content;
  const std::int32_t visible_set = lookup.cell ? placement.cells[*lookup.cell].visible_set : -1;
  if (visible_set >= 0) {
    content.objects = placement.visible_sets[static_cast<std::size_t>(visible_set)];
  } else {
    content.objects.resize(object_count);
    std::iota(content.objects.begin(), content.objects.end(), 0U);
  }
  if (!lookup.cpv) {
    content.levels = levels_of(placement, lookup, content.objects);
    return content;
  }
  content.impostors = placement.cpvs[*lookup.cpv].impostors;
  std::vector<std::uint32_t> replaced;
  for (const std::uint32_t impostor : content.impostors) {
    const auto& objects = placement.impostors[impostor].objects;
    replaced.insert(replaced.end(), objects.begin(), objects.end());
  }
  std::sort(replaced.begin(), replaced.end());
  content.objects = without(content.objects, replaced);
  content.levels = levels_of(placement, lookup, content.objects);
  return content;
}

}  // namespace standin
