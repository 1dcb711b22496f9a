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
  return {{placement.root_min, placement.root_side_m}, keys, boxes};
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
  return static_cast<std::uint8_t>(level_shown(lookup_vector(cell.min), lookup_vector(cell.max), lookup_vector(bounds.min),
                                               lookup_vector(bounds.max), least_distance_m));
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

PlacementIndex::PlacementIndex(const Placement& placement) : cells_(locate_cells(placement)) {
  for (std::size_t i = 0; i < placement.intervals.size(); ++i) {
    const DirectionInterval& interval = placement.intervals[i];
    require(i == 0 || placement.intervals[i - 1] < interval, "interval", i, "does not follow its predecessor");
    require(0 <= interval.level && interval.level <= kDeepestIntervalLevel, "interval", i, "has an impossible level");
    intervals_.push_back({static_cast<int>(interval.face), interval.level, {interval.i, interval.j}});
  }
  interval_levels_ = levels_in_use(intervals_);
  check_cpvs(placement);
  for (const PlacementCpv& cpv : placement.cpvs) cpvs_.push_back({cpv.cell, cpv.interval});
}

Lookup PlacementIndex::find(const Vec3& position, const Vec3& direction) const {
  PlacementView view = cells_.view();
  view.intervals = intervals_;
  view.cpvs = cpvs_;
  view.interval_levels = interval_levels_;
  return find_cell(view, lookup_vector(position), lookup_vector(direction));
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
