// How low the budget may go: the lowest bound that all, 99 %, 90 % of the views can be brought under by any candidates (feasibility before
// selection).
//
// Regions whose bound is below a threshold need no impostor to stay below it, so the tree DP runs only over the regions above one. The
// threshold is lowered, never below what some region can be brought to, until some region cannot get below it: the greatest reachable time
// is exact from there on. The quantiles are upper bounds: every region below the threshold counts as much as it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "placement/candidates/candidates.h"
#include "placement/view_space/subdivision.h"
#include "server/job/world.h"

namespace standin {

struct ReachSummary {
  Subdivision subdivision;           // at the last threshold
  std::vector<double> reachable_ms;  // bound, per CPV of `subdivision`
  std::uint64_t regions = 0;         // leaf regions in all
  bool known = false;                // false: of all that follows only worst_bound_ms is
  double all_ms = 0.0;               // bounds, milliseconds
  double p99_ms = 0.0;
  double p90_ms = 0.0;
  double worst_bound_ms = 0.0;          // once the cells that are slow have been halved: at a budget above it, there is no problem view
  std::vector<std::uint32_t> blockers;  // objects that make up most of what is left in the worst region
};

/// `whole`: the regions of the view space, without a budget. `searches`: of the same world, looked at and added to; or none.
[[nodiscard]] ReachSummary summarise_reach(const World& world, const TimeModel& model, const Subdivision& whole, const SizeModels& sizes,
                                           const CandidateOptions& options, const WorkBudget& budget, SearchMemory* searches);
/// The same where nobody asks how low the budget may go: worst_bound_ms alone is known.
[[nodiscard]] ReachSummary without_reach(const TimeModel& model, Subdivision problem);

/// Value at rank floor(share * (total - 1)) of `values` filled up with `fill` to `total` entries, fill being no greater than any of them.
[[nodiscard]] double padded_quantile(std::vector<double> values, std::uint64_t total, double fill, double share);

}  // namespace standin
