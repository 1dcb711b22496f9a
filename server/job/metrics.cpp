#include "server/job/metrics.h"

#include <sys/resource.h>

#include <algorithm>
#include <map>

namespace standin {
namespace {

using nlohmann::json;

// Highest bound after placement per cell: of its CPVs, and of its regions that are none (those keep theirs, which is within the budget).
std::vector<double> after_per_cell(const Subdivision& subdivision, const Placement& placement) {
  std::vector<double> after_ms(subdivision.cells.size(), 0.0);
  for (const auto& cpv : placement.cpvs) after_ms[cpv.cell] = std::max(after_ms[cpv.cell], cpv.bound_after_ms);
  return after_ms;
}

// Index of the slowest CPV of each cell that has any.
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

struct CauseShares {
  double draws_ms = 0.0, triangles_ms = 0.0, pixels_ms = 0.0;

  void add(const Features& features, const TimeModel& model, bool pixels_capped) {
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
  void add(const CauseShares& other) {
    draws_ms += other.draws_ms;
    triangles_ms += other.triangles_ms;
    pixels_ms += other.pixels_ms;
  }
  [[nodiscard]] double share(double ms) const {
    const double total_ms = draws_ms + triangles_ms + pixels_ms;
    return total_ms > 0.0 ? ms / total_ms : 0.0;
  }
  [[nodiscard]] json to_json() const {
    return {{"draws_share", share(draws_ms)}, {"triangles_share", share(triangles_ms)}, {"pixels_share", share(pixels_ms)}};
  }
};

CauseShares shares_of(const World& world, const FeatureTable& table, const Subdivision& subdivision, const Cpv& cpv,
                      const TimeModel& model) {
  const Box& box = subdivision.cells[cpv.cell].box;
  const Gaze gaze(enclosing_cone(subdivision.intervals[cpv.interval], world.camera), box, world.camera);
  CauseShares shares;
  for (const auto& term : subdivision.terms_of(cpv))
    shares.add(table.bound(table.from_box(term.object, box), gaze), model, cpv.pixels_capped);
  if (cpv.pixels_capped) shares.pixels_ms += model.most_pixel_ms(table.pixel_terms(), table.most_passed_pixels());
  return shares;
}

// By cell: of its slowest region.
std::map<std::uint32_t, json> cause_per_cell(const World& world, const Subdivision& subdivision, const TimeModel& model) {
  constexpr std::size_t kNamedObjects = 3;
  const FeatureTable table(world.scene, world.camera);
  std::map<std::uint32_t, json> causes;
  for (const auto p : slowest_cpv_per_cell(subdivision)) {
    const Cpv& cpv = subdivision.cpvs[p];
    const auto terms = subdivision.terms_of(cpv);
    json& cause = causes[cpv.cell] = shares_of(world, table, subdivision, cpv, model).to_json();
    cause["objects"] = objects_json(world, largest_terms({terms.begin(), terms.end()}, kNamedObjects));
  }
  return causes;
}

}  // namespace

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

json heat_map_json(const World& world, const Subdivision& subdivision, const Placement* placement, const TimeModel& model) {
  const auto causes = cause_per_cell(world, subdivision, model);
  const auto after_ms = placement != nullptr ? after_per_cell(subdivision, *placement) : std::vector<double>();
  json map = json::array();
  for (std::size_t c = 0; c < subdivision.cells.size(); ++c) {
    const Cell& cell = subdivision.cells[c];
    const double before_ms = model.bound_ms(cell.worst_predicted_ms);
    json after;
    if (placement != nullptr) after = after_ms[c] > 0.0 ? after_ms[c] : before_ms;
    map.push_back({{"x0", cell.box.min.x},
                   {"z0", cell.box.min.z},
                   {"x1", cell.box.max.x},
                   {"z1", cell.box.max.z},
                   {"before_ms", before_ms},
                   {"after_ms", after}});
    if (const auto cause = causes.find(static_cast<std::uint32_t>(c)); cause != causes.end()) map.back()["cause"] = cause->second;
  }
  return map;
}

json causes_json(const World& world, const Subdivision& subdivision, const TimeModel& model) {
  const FeatureTable table(world.scene, world.camera);
  CauseShares shares;
  std::map<std::uint32_t, double> by_object;
  for (const auto p : slowest_cpv_per_cell(subdivision)) {
    const Cpv& cpv = subdivision.cpvs[p];
    shares.add(shares_of(world, table, subdivision, cpv, model));
    for (const auto& term : subdivision.terms_of(cpv)) by_object[term.object] += term.predicted_ms;
  }
  std::vector<RegionTerm> objects;
  for (const auto& [object, ms] : by_object) objects.push_back({object, ms});
  json causes = shares.to_json();
  causes["objects"] = objects_json(world, largest_terms(std::move(objects), 20));
  return causes;
}

json slow_views_json(const std::vector<SlowView>& slow) {
  json list = json::array();
  for (const SlowView& one : slow) {
    const View& view = one.surveyed.view;
    list.push_back({{"position", {view.position.x, view.position.y, view.position.z}},
                    {"direction", {view.direction.x, view.direction.y, view.direction.z}},
                    {"frame_ms", one.surveyed.predicted_ms}});
  }
  return list;
}

std::vector<View> slow_views_from_json(const json& worst_views) {
  const auto vec3 = [](const json& xyz) { return Vec3(xyz.at(0).get<double>(), xyz.at(1).get<double>(), xyz.at(2).get<double>()); };
  std::vector<View> views;
  for (const json& one : worst_views) views.push_back({vec3(one.at("position")), vec3(one.at("direction"))});
  return views;
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace standin
