// The part of metrics.json that speaks of a placement: regions solved, impostors, memory, the lower bound, how the selection got there.
#pragma once

#include <nlohmann/json.hpp>

#include "server/job/place_at_budget.h"

namespace standin {

/// metrics.json: cpv, candidates, impostors, select.
[[nodiscard]] nlohmann::json cpv_json(const Placement& placement);
[[nodiscard]] nlohmann::json candidates_json(const CandidateSet& candidates);
[[nodiscard]] nlohmann::json impostor_counts(const Placement& placement);
[[nodiscard]] nlohmann::json select_metrics(const SelectedImpostors& selected, const Placement& placement);
/// memory, but for what needs the pages themselves (gpu_memory.h).
[[nodiscard]] nlohmann::json memory_json(const Placed& placed, const LodFigures& lods);
/// bound
[[nodiscard]] nlohmann::json bound_json(const SelectedImpostors& selected);

}  // namespace standin
