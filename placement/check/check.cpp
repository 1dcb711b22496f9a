#include "placement/check/check.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/region_bound.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/scene/level_errors.h"

namespace standin {
namespace {

// Recomputed sums may differ from stored ones in the last bits when the file was written by another build.
constexpr double kRelativeTolerance = 1e-9;

bool agrees(double a, double b) {
  return std::abs(a - b) <= kRelativeTolerance * std::max(std::abs(a), std::abs(b));
}

std::string milliseconds(double value) {
  return std::to_string(value) + " ms";
}

class Checker {
 public:
  Checker(const CheckInput& input, const Placement& placement)
      : input_(input),
        placement_(placement),
        cell_boxes_(input.view_space),
        estimator_(input.scene, input.hierarchy_rank, input.model, input.camera, input.view_space_options),
        page_switches_ms_(input.atlas_pages * input.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTextureSwitches)]) {
    everything_.resize(input.scene.objects.size());
    std::iota(everything_.begin(), everything_.end(), 0U);
    for (std::uint32_t p = 0; p < placement.cpvs.size(); ++p) cpvs_of_cell_[placement.cpvs[p].cell].push_back(p);
    for (const auto& impostor : placement.impostors) impostor_costs_.push_back(impostor_cost_bound(impostor));
  }

  [[nodiscard]] std::vector<CheckFinding> check_impostors() const {
    std::vector<CheckFinding> findings;
    for (std::uint32_t id = 0; id < impostor_costs_.size(); ++id)
      if (!impostor_costs_[id])
        findings.push_back(
            {Violation::kLayerInViewCell, id, "impostor " + std::to_string(id) + ": its view cell reaches one of its layers"});
    return findings;
  }

  // The scene's levels are those that are shown (read_levels): they must lie no farther off than they say, and distances be the scene's.
  [[nodiscard]] std::vector<CheckFinding> check_levels(const WorkBudget& budget) const {
    std::vector<CheckFinding> findings;
    for (const LevelFault& fault : level_faults(input_.scene, input_.levels, budget))
      findings.push_back({Violation::kLevels, fault.object, fault.sentence});
    for (const PlacementLevels& stated : placement_.levels)
      if (!(stated.bounds == input_.scene.objects[stated.object].bounds))
        findings.push_back(
            {Violation::kLevels, stated.object, "object " + std::to_string(stated.object) + ": bounds differ from the scene's"});
    return findings;
  }

  // All findings of one cell: its box, its CPVs, and the regions it should list but does not.
  std::vector<CheckFinding> check_cell(std::uint32_t cell_id, std::uint64_t& regions) const {
    std::vector<CheckFinding> findings;
    const PlacementCell& cell = placement_.cells[cell_id];
    const Box box = cell_boxes_.cell_box(cell.key);
    if (!(box == cell.box))
      findings.push_back({Violation::kCellBox, cell_id, "cell " + std::to_string(cell_id) + ": box differs from the view space's"});
    CellCosts costs = estimator_.cell_costs(cell_boxes_.chain(cell.key), visible(cell), cell_boxes_.parts(cell.key));
    std::set<DirectionInterval> listed;
    if (const auto found = cpvs_of_cell_.find(cell_id); found != cpvs_of_cell_.end()) {
      for (const auto p : found->second) {
        listed.insert(placement_.intervals[placement_.cpvs[p].interval]);
        check_cpv(p, cell, costs, findings);
      }
    }
    check_unlisted(cell_id, costs, listed, findings, regions);
    return findings;
  }

 private:
  [[nodiscard]] const std::vector<std::uint32_t>& visible(const PlacementCell& cell) const {
    return cell.visible_set < 0 ? everything_ : placement_.visible_sets[static_cast<std::size_t>(cell.visible_set)];
  }

  void check_cpv(std::uint32_t p, const PlacementCell& cell, CellCosts& costs, std::vector<CheckFinding>& findings) const {
    const PlacementCpv& cpv = placement_.cpvs[p];
    const std::string place = "cpv " + std::to_string(p);
    const auto report = [&](Violation violation, const std::string& what) { findings.push_back({violation, p, place + ": " + what}); };
    const RegionBound bound = estimator_.region_bound(costs, placement_.intervals[cpv.interval]);
    const double before_ms = input_.model.bound_ms(bound.predicted_ms);
    if (!agrees(before_ms, cpv.bound_before_ms))
      report(Violation::kBoundBefore, "bound_before_ms = " + milliseconds(cpv.bound_before_ms) + ", recomputed " + milliseconds(before_ms));
    if (has_bound(cpv)) check_after(cpv, input_.model.bound_ms(after(bound, cpv)), report);
    for (const auto id : cpv.impostors)
      if (!encloses(placement_.impostors[id].view_cell, cell.box))
        report(Violation::kNotEnclosed, "its cell is not inside the view cell of impostor " + std::to_string(id));
    if (!disjoint(cpv)) report(Violation::kNotDisjoint, "two of its impostors stand for the same object");
  }

  template <class Report>
  void check_after(const PlacementCpv& cpv, double after_ms, const Report& report) const {
    if (!agrees(after_ms, cpv.bound_after_ms))
      report(Violation::kBoundAfter, "bound_after_ms = " + milliseconds(cpv.bound_after_ms) + ", recomputed " + milliseconds(after_ms));
    const double slack_ms = kRelativeTolerance * input_.budget_ms;
    if (cpv.solved && after_ms > input_.budget_ms + slack_ms)
      report(Violation::kOverBudget, "solved, but its bound " + milliseconds(after_ms) + " violates <= " + milliseconds(input_.budget_ms));
    if (!cpv.solved && after_ms <= input_.budget_ms - slack_ms) report(Violation::kNotSolved, "unsolved, but its bound meets the budget");
  }

  [[nodiscard]] bool disjoint(const PlacementCpv& cpv) const {
    std::vector<std::uint32_t> objects;
    for (const auto id : cpv.impostors)
      objects.insert(objects.end(), placement_.impostors[id].objects.begin(), placement_.impostors[id].objects.end());
    std::ranges::sort(objects);
    return std::ranges::adjacent_find(objects) == objects.end();
  }

  [[nodiscard]] double after(const RegionBound& bound, const PlacementCpv& cpv) const {
    double sum = bound.constant_ms;
    for (const auto& term : bound.terms) {
      const bool replaced = std::ranges::any_of(
          cpv.impostors, [&](std::uint32_t id) { return std::ranges::binary_search(placement_.impostors[id].objects, term.object); });
      if (!replaced) sum += term.predicted_ms;
    }
    for (const auto id : cpv.impostors) {
      const Cost& cost = *impostor_costs_[id];
      sum += bound.pixels_capped ? cost.fixed_ms : cost.fixed_ms + cost.pixel_ms;
    }
    return cpv.impostors.empty() ? sum : sum + page_switches_ms_;
  }

  // Nothing where the view cell reaches a layer: seen from there, its pixels have no bound.
  [[nodiscard]] std::optional<Cost> impostor_cost_bound(const PlacementImpostor& impostor) const {
    Impostor geometry;
    geometry.view_cell = impostor.view_cell;
    geometry.frame = impostor.frame;
    geometry.layers = impostor.layers;
    try {
      ImpostorCost known = impostor_cost(geometry);
      known.quads = impostor.quads;
      known.texels = static_cast<double>(impostor.texels);
      return input_.model.cost(impostor_features_bound(known, input_.camera));
    } catch (const Failure&) {
      return std::nullopt;
    }
  }

  [[nodiscard]] bool has_bound(const PlacementCpv& cpv) const {
    return std::ranges::all_of(cpv.impostors, [&](std::uint32_t id) { return impostor_costs_[id].has_value(); });
  }

  // Depth first over the direction quadtree; a node within the budget vouches for all below it.
  void check_unlisted(std::uint32_t cell_id, CellCosts& costs, const std::set<DirectionInterval>& listed,
                      std::vector<CheckFinding>& findings, std::uint64_t& regions) const {
    std::vector<DirectionInterval> pending;
    for (int face = 0; face < kFaceCount; ++face) pending.push_back({static_cast<Face>(face), 0, 0, 0});
    while (!pending.empty()) {
      const DirectionInterval interval = pending.back();
      pending.pop_back();
      if (listed.contains(interval)) continue;
      ++regions;
      const auto is_slow = [&](double bound_ms) { return bound_ms > input_.budget_ms * (1.0 + kRelativeTolerance); };
      if (!is_slow(input_.model.bound_ms(estimator_.coarse_bound_ms(costs, interval)))) continue;
      double bound_ms = std::numeric_limits<double>::infinity();
      if (interval.level >= estimator_.first_sharp_level(costs))
        bound_ms = input_.model.bound_ms(estimator_.region_bound(costs, interval).predicted_ms);
      if (!is_slow(bound_ms)) continue;
      if (interval.level < estimator_.leaf_level(costs))
        for (int k = 0; k < 4; ++k) pending.push_back(interval.child(k));
      else
        findings.push_back({Violation::kMissingRegion, cell_id,
                            "cell " + std::to_string(cell_id) + ": face " + std::string(face_frame(interval.face).name) + " interval " +
                                std::to_string(interval.i) + "," + std::to_string(interval.j) + " has a bound of " +
                                milliseconds(bound_ms) + " and is no CPV"});
    }
  }

  const CheckInput& input_;
  const Placement& placement_;
  CellBoxes cell_boxes_;
  RegionEstimator estimator_;
  double page_switches_ms_;
  std::vector<std::uint32_t> everything_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> cpvs_of_cell_;
  std::vector<std::optional<Cost>> impostor_costs_;
};

}  // namespace

const char* violation_name(Violation violation) {
  switch (violation) {
    case Violation::kCellBox:
      return "cell_box";
    case Violation::kBoundBefore:
      return "bound_before";
    case Violation::kBoundAfter:
      return "bound_after";
    case Violation::kOverBudget:
      return "over_budget";
    case Violation::kNotSolved:
      return "not_solved";
    case Violation::kNotDisjoint:
      return "not_disjoint";
    case Violation::kNotEnclosed:
      return "not_enclosed";
    case Violation::kMissingRegion:
      return "missing_region";
    case Violation::kLevels:
      return "levels";
    case Violation::kLayerInViewCell:
      break;
  }
  return "layer_in_view_cell";
}

CheckReport check_placement(const CheckInput& input, const Placement& placement, int threads, const WorkBudget& budget) {
  const Checker checker(input, placement);
  std::vector<std::vector<CheckFinding>> findings(placement.cells.size());
  std::vector<std::uint64_t> regions(placement.cells.size(), 0);
  parallel_for(placement.cells.size(), threads, budget,
               [&](std::size_t cell) { findings[cell] = checker.check_cell(static_cast<std::uint32_t>(cell), regions[cell]); });
  CheckReport report;
  report.cpvs = static_cast<std::uint32_t>(placement.cpvs.size());
  for (const auto& cpv : placement.cpvs) {
    report.solved += cpv.solved ? 1 : 0;
    report.worst_bound_after_ms = std::max(report.worst_bound_after_ms, cpv.bound_after_ms);
  }
  for (const auto& impostor : placement.impostors) {
    report.texture_bytes += impostor.texture_bytes;
    report.geometry_bytes += impostor.geometry_bytes;
  }
  report.regions = std::accumulate(regions.begin(), regions.end(), std::uint64_t{0}) + report.cpvs;
  report.findings = checker.check_impostors();
  const auto start = std::chrono::steady_clock::now();
  const std::vector<CheckFinding> of_levels = checker.check_levels(budget);
  report.levels_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.findings.insert(report.findings.end(), of_levels.begin(), of_levels.end());
  for (auto& of_cell : findings) report.findings.insert(report.findings.end(), of_cell.begin(), of_cell.end());
  return report;
}

}  // namespace standin
