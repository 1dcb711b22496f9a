// Regions without a solution: what is missing in each, and what makes it so.
//
// A budget far below what is reachable leaves hundreds of thousands of them, so only the worst are described one by one; all of them are
// counted by place and by cause.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/select/selection_problem.h"
#include "placement/view_space/subdivision.h"
#include "server/job/world.h"

namespace standin {

/// Members of metrics.json:
///   unsolved           the worst 200 by lowest_budget_ms: region, bounds, residual of the best set of disjoint candidates (of those that
///                      were baked, where the rounds ended too early), the lowest budget that would do, and the dearest objects still
///                      drawn ("blocking")
///   unsolved_by_cell   per leaf cell (before halving): regions, and the lowest budget that would do for all of them
///   unsolved_by_object per object that is the dearest one still drawn somewhere: regions, and its milliseconds in the worst of them
[[nodiscard]] nlohmann::json unsolved_json(const World& world, const Subdivision& subdivision, const Placement& placement,
                                           const Selection& selection, const TimeModel& model, double budget_ms);

}  // namespace standin
