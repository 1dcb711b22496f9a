// Parts of metrics.json that need more than a copy: heat map, causes, unsolved regions. Units in the key names, as everywhere in that file.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "estimation/time_model.h"
#include "placement/candidates/candidates.h"
#include "placement/runtime/placement.h"
#include "placement/select/selection_problem.h"
#include "placement/view_space/subdivision.h"
#include "server/job/world.h"

namespace standin {

/// Per cell in plan view: the highest bound of any direction, before and (where there is a placement) after.
[[nodiscard]] nlohmann::json heat_map_json(const Subdivision& subdivision, const Placement* placement, const TimeModel& model);

/// What makes the slowest region of each cell slow: predicted milliseconds by draws, triangles and pixels, and the objects that cost most,
/// summed over these regions.
[[nodiscard]] nlohmann::json causes_json(const World& world, const Subdivision& subdivision, const TimeModel& model);

/// One entry per CPV that is not solved: its region, the residual of its best set of disjoint candidates, the objects that make it so, and
/// the lowest budget that would do.
[[nodiscard]] nlohmann::json unsolved_json(const World& world, const Subdivision& subdivision, const Placement& placement,
                                           const Selection& selection, const TimeModel& model, double budget_ms);

[[nodiscard]] std::uint64_t peak_rss_bytes();

}  // namespace standin
