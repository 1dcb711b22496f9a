#include "server/job/metrics.h"

#include <sys/resource.h>

#include <algorithm>

namespace standin {
namespace {

using nlohmann::json;

// Highest bound after placement per cell: of its CPVs, and of its regions that are none (those keep theirs, which is within the budget).
std::vector<double> after_per_cell(const Subdivision& subdivision, const Placement& placement) {
  std::vector<double> after_ms(subdivision.cells.size(), 0.0);
  for (const auto& cpv : placement.cpvs) after_ms[cpv.cell] = std::max(after_ms[cpv.cell], cpv.bound_after_ms);
  return after_ms;
}

}  // namespace

json heat_map_json(const World& world, const Subdivision& subdivision, const std::vector<CellCause>& causes, const Placement* placement,
                   const TimeModel& model) {
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
  }
  for (const CellCause& cause : causes) map[cause.cell]["cause"] = cause_json(world, cause);
  return map;
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
