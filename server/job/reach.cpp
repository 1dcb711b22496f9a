#include "server/job/reach.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

// The first threshold is this share of the worst bound, each later one at least this share of the one before; a scene that can be brought
// below the last one is called reachable there.
constexpr double kShare = 0.6;
constexpr double kLeastShare = 0.03;

Subdivision subdivide_at(const World& world, const TimeModel& model, double predicted_ms, const WorkBudget& budget,
                         SearchMemory* searches) {
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = predicted_ms;
  return subdivide(world.scene, world.hierarchy.rank, world.view_space, world.visibility, model, world.camera, world.view_space_options,
                   options, budget, searches);
}

std::uint64_t leaf_regions(const Subdivision& subdivision, const ViewSpaceOptions& options, int leaf_level) {
  const int level = level_for_width(options.interval_deg);
  std::uint64_t regions = 0;
  for (const Cell& cell : subdivision.cells)
    regions += kFaceCount * (std::uint64_t{1} << (2 * direction_level(level, cell.key.level - leaf_level)));
  return regions;
}

}  // namespace

double padded_quantile(std::vector<double> values, std::uint64_t total, double fill, double share) {
  const auto rank = static_cast<std::uint64_t>(std::floor(share * static_cast<double>(total - 1)));
  const std::uint64_t filled = total - values.size();
  if (rank < filled) return fill;
  const auto position = values.begin() + static_cast<std::ptrdiff_t>(rank - filled);
  std::nth_element(values.begin(), position, values.end());
  return *position;
}

ReachSummary without_reach(const TimeModel& model, Subdivision problem) {
  ReachSummary summary;
  summary.worst_bound_ms = model.bound_ms(problem.worst_predicted_ms);
  summary.subdivision = std::move(problem);
  return summary;
}

ReachSummary summarise_reach(const World& world, const TimeModel& model, const Subdivision& whole, const SizeModels& sizes,
                             const CandidateOptions& options, const WorkBudget& budget, SearchMemory* searches) {
  ReachSummary summary;
  summary.known = true;
  double worst_ms = whole.worst_predicted_ms;
  double threshold_ms = kShare * worst_ms;
  while (threshold_ms > kLeastShare * whole.worst_predicted_ms) {
    summary.subdivision = subdivide_at(world, model, threshold_ms, budget, searches);
    worst_ms = std::min(worst_ms, summary.subdivision.worst_predicted_ms);
    const Reach reach =
        reachable_times(world.scene, world.hierarchy, summary.subdivision, model, sizes, world.camera, world.quality, options, budget);
    summary.reachable_ms.clear();
    for (const double predicted : reach.predicted_ms) summary.reachable_ms.push_back(std::max(predicted, threshold_ms));
    const auto worst = std::ranges::max_element(reach.predicted_ms);
    const double reached_ms = worst != reach.predicted_ms.end() ? *worst : 0.0;
    if (worst != reach.predicted_ms.end()) summary.blockers = reach.blockers[static_cast<std::size_t>(worst - reach.predicted_ms.begin())];
    if (reached_ms >= threshold_ms) break;
    threshold_ms = std::max(reached_ms, kShare * threshold_ms);
  }
  summary.regions = leaf_regions(summary.subdivision, world.view_space_options, world.view_space.leaf_level);
  const double fill_ms = summary.reachable_ms.empty() ? worst_ms : *std::ranges::min_element(summary.reachable_ms);
  const auto quantile = [&](double share) {
    return model.bound_ms(padded_quantile(summary.reachable_ms, summary.regions, fill_ms, share));
  };
  summary.worst_bound_ms = model.bound_ms(worst_ms);
  summary.all_ms = quantile(1.0);
  summary.p99_ms = quantile(0.99);
  summary.p90_ms = quantile(0.90);
  for (auto& value : summary.reachable_ms) value = model.bound_ms(value);
  return summary;
}

}  // namespace standin
