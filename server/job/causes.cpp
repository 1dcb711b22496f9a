#include "server/job/causes.h"

#include <algorithm>
#include <map>

#include "render/base/parallel.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr std::size_t kNamedOfCell = 3;
constexpr std::size_t kNamedOfAll = 20;

// Index of the slowest CPV of each cell that has any, by cell.
std::vector<std::size_t> slowest_cpv_per_cell(const Subdivision& subdivision) {
  std::map<std::uint32_t, std::size_t> slowest;
  for (std::size_t p = 0; p < subdivision.cpvs.size(); ++p) {
    const auto [entry, is_new] = slowest.try_emplace(subdivision.cpvs[p].cell, p);
    if (!is_new && subdivision.cpvs[p].predicted_ms > subdivision.cpvs[entry->second].predicted_ms) entry->second = p;
  }
  std::vector<std::size_t> list;
  for (const auto& [cell, p] : slowest) list.push_back(p);
  return list;
}

CauseShares shares_of(const World& world, const FeatureTable& table, const Subdivision& subdivision, const Cpv& cpv,
                      const TimeModel& model) {
  const Box& box = subdivision.cells[cpv.cell].box;
  const Gaze gaze(enclosing_cone(subdivision.intervals[cpv.interval], world.camera), box, world.camera);
  CauseShares shares;
  for (const auto& term : subdivision.terms_of(cpv))
    shares.add(table.bound(table.from_box(term.object, {box, box}), gaze), model, cpv.pixels_capped);
  if (cpv.pixels_capped) shares.pixels_ms += model.most_pixel_ms(table.pixel_terms(), table.most_passed_pixels());
  return shares;
}

}  // namespace

void CauseShares::add(const Features& features, const TimeModel& model, bool pixels_capped) {
  for (std::size_t i = 0; i < kTermCount; ++i) {
    const auto term = static_cast<Term>(i);
    const double ms = features.value[i] * model.milliseconds_per_unit[i];
    if (term == Term::kDraws || term == Term::kTextureSwitches)
      draws_ms += ms;
    else if (!is_pixel_term(term))
      triangles_ms += ms;
    else if (!pixels_capped)
      pixels_ms += ms;
  }
}

void CauseShares::add(const CauseShares& other) {
  draws_ms += other.draws_ms;
  triangles_ms += other.triangles_ms;
  pixels_ms += other.pixels_ms;
}

json CauseShares::to_json() const {
  const double total_ms = draws_ms + triangles_ms + pixels_ms;
  const auto share = [&](double ms) { return total_ms > 0.0 ? ms / total_ms : 0.0; };
  return {{"draws_share", share(draws_ms)}, {"triangles_share", share(triangles_ms)}, {"pixels_share", share(pixels_ms)}};
}

std::vector<CellCause> causes_per_cell(const World& world, const Subdivision& subdivision, const TimeModel& model,
                                       const WorkBudget& budget) {
  const std::vector<std::size_t> slowest = slowest_cpv_per_cell(subdivision);
  std::vector<CellCause> causes(slowest.size());
  if (causes.empty()) return causes;
  const FeatureTable table(world.scene, world.camera);
  parallel_for(slowest.size(), world.threads, budget, [&](std::size_t i) {
    const Cpv& cpv = subdivision.cpvs[slowest[i]];
    causes[i] = {cpv.cell, shares_of(world, table, subdivision, cpv, model), subdivision.terms_of(cpv)};
  });
  return causes;
}

json cause_json(const World& world, const CellCause& cause) {
  json object = cause.shares.to_json();
  object["objects"] = objects_json(world, largest_terms({cause.terms.begin(), cause.terms.end()}, kNamedOfCell));
  return object;
}

json causes_json(const World& world, const std::vector<CellCause>& causes) {
  CauseShares shares;
  std::map<std::uint32_t, double> by_object;
  for (const CellCause& cause : causes) {
    shares.add(cause.shares);
    for (const RegionTerm& term : cause.terms) by_object[term.object] += term.predicted_ms;
  }
  std::vector<RegionTerm> objects;
  for (const auto& [object, ms] : by_object) objects.push_back({object, ms});
  json all = shares.to_json();
  all["objects"] = objects_json(world, largest_terms(std::move(objects), kNamedOfAll));
  return all;
}

std::vector<RegionTerm> largest_terms(std::vector<RegionTerm> terms, std::size_t count) {
  const auto larger = [](const RegionTerm& a, const RegionTerm& b) {
    return a.predicted_ms != b.predicted_ms ? a.predicted_ms > b.predicted_ms : a.object < b.object;
  };
  const auto middle = terms.begin() + static_cast<std::ptrdiff_t>(std::min(count, terms.size()));
  std::partial_sort(terms.begin(), middle, terms.end(), larger);
  terms.erase(middle, terms.end());
  return terms;
}

json objects_json(const World& world, const std::vector<RegionTerm>& terms) {
  json list = json::array();
  for (const auto& term : terms)
    list.push_back({{"object", term.object}, {"name", world.scene.objects[term.object].name}, {"ms", term.predicted_ms}});
  return list;
}

}  // namespace standin
