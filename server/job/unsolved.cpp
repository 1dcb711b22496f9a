#include "server/job/unsolved.h"

#include <algorithm>
#include <map>

#include "server/job/causes.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr std::size_t kDescribed = 200;
constexpr std::size_t kNamedObjects = 5;

struct UnsolvedRegion {
  std::uint32_t cpv = 0;
  double residual_ms = 0.0;
  double lowest_budget_ms = 0.0;
};

std::string region_name(const Subdivision& subdivision, const Cpv& cpv) {
  const DirectionInterval& interval = subdivision.intervals[cpv.interval];
  const auto& index = subdivision.cells[cpv.cell].key.index;
  return "cell " + std::to_string(index[0]) + "," + std::to_string(index[1]) + "," + std::to_string(index[2]) + ", facing " +
         std::string(face_frame(interval.face).name) + " " + std::to_string(interval.i) + "," + std::to_string(interval.j);
}

// Originals that are still drawn in a CPV.
std::vector<RegionTerm> drawn_terms(const Subdivision& subdivision, const Cpv& cpv, const Placement& placement,
                                    const PlacementCpv& placed) {
  std::vector<RegionTerm> drawn;
  for (const auto& term : subdivision.terms_of(cpv)) {
    const bool replaced = std::ranges::any_of(
        placed.impostors, [&](std::uint32_t id) { return std::ranges::binary_search(placement.impostors[id].objects, term.object); });
    if (!replaced) drawn.push_back(term);
  }
  return drawn;
}

std::vector<UnsolvedRegion> unsolved_regions(const Placement& placement, const Selection& selection, const TimeModel& model,
                                             double budget_ms) {
  std::map<std::uint32_t, double> residual_of;
  for (const auto& shortfall : selection.summary.unmet) residual_of[shortfall.cpv] = shortfall.residual;
  const double predicted_budget_ms = model.predicted_budget_ms(budget_ms);
  std::vector<UnsolvedRegion> regions;
  for (std::uint32_t p = 0; p < placement.cpvs.size(); ++p) {
    const PlacementCpv& placed = placement.cpvs[p];
    if (placed.solved) continue;
    const auto known = residual_of.find(p);
    if (known != residual_of.end())
      regions.push_back({p, known->second, model.bound_ms(predicted_budget_ms + known->second)});
    else
      regions.push_back({p, placed.bound_after_ms - budget_ms, placed.bound_after_ms});
  }
  return regions;
}

/// Regions counted by place or cause, with the worst of them.
struct Tally {
  std::uint64_t regions = 0;
  double worst_ms = 0.0;
  void add(double ms) {
    ++regions;
    worst_ms = std::max(worst_ms, ms);
  }
};

class Description {
 public:
  Description(const World& world, const Subdivision& subdivision, const Placement& placement)
      : world_(world), subdivision_(subdivision), placement_(placement) {}

  [[nodiscard]] json worst(std::vector<UnsolvedRegion> regions) const {
    std::ranges::stable_sort(regions, std::greater(), &UnsolvedRegion::lowest_budget_ms);
    regions.resize(std::min(regions.size(), kDescribed));
    json list = json::array();
    for (const auto& region : regions) {
      const PlacementCpv& placed = placement_.cpvs[region.cpv];
      list.push_back({{"cpv", region.cpv},
                      {"region", region_name(subdivision_, subdivision_.cpvs[region.cpv])},
                      {"bound_before_ms", placed.bound_before_ms},
                      {"bound_after_ms", placed.bound_after_ms},
                      {"residual_ms", region.residual_ms},
                      {"lowest_budget_ms", region.lowest_budget_ms},
                      {"blocking", objects_json(world_, dearest(region.cpv, kNamedObjects))}});
    }
    return list;
  }

  [[nodiscard]] json by_cell(const std::vector<UnsolvedRegion>& regions) const {
    std::map<CellKey, Tally> tallies;
    for (const auto& region : regions) tallies[leaf_of(region.cpv)].add(region.lowest_budget_ms);
    json list = json::array();
    for (const auto& [key, tally] : tallies)
      list.push_back({{"level", key.level}, {"index", key.index}, {"regions", tally.regions}, {"lowest_budget_ms", tally.worst_ms}});
    return list;
  }

  [[nodiscard]] json by_object(const std::vector<UnsolvedRegion>& regions) const {
    std::map<std::uint32_t, Tally> tallies;
    for (const auto& region : regions)
      for (const auto& term : dearest(region.cpv, 1)) tallies[term.object].add(term.predicted_ms);
    std::vector<std::pair<std::uint32_t, Tally>> most(tallies.begin(), tallies.end());
    std::ranges::stable_sort(most, std::greater(), [](const auto& entry) { return entry.second.regions; });
    json list = json::array();
    for (const auto& [object, tally] : most)
      list.push_back(
          {{"object", object}, {"name", world_.scene.objects[object].name}, {"regions", tally.regions}, {"worst_ms", tally.worst_ms}});
    return list;
  }

 private:
  [[nodiscard]] std::vector<RegionTerm> dearest(std::uint32_t cpv, std::size_t count) const {
    return largest_terms(drawn_terms(subdivision_, subdivision_.cpvs[cpv], placement_, placement_.cpvs[cpv]), count);
  }
  [[nodiscard]] CellKey leaf_of(std::uint32_t cpv) const {
    CellKey key = subdivision_.cells[subdivision_.cpvs[cpv].cell].key;
    while (key.level > world_.view_space.leaf_level) key = key.parent();
    return key;
  }

  const World& world_;
  const Subdivision& subdivision_;
  const Placement& placement_;
};

}  // namespace

json unsolved_json(const World& world, const Subdivision& subdivision, const Placement& placement, const Selection& selection,
                   const TimeModel& model, double budget_ms) {
  const auto regions = unsolved_regions(placement, selection, model, budget_ms);
  const Description description(world, subdivision, placement);
  return {{"unsolved", description.worst(regions)},
          {"unsolved_by_cell", description.by_cell(regions)},
          {"unsolved_by_object", description.by_object(regions)}};
}

}  // namespace standin
