// Memory against the budget, in one run (thesis Table 5.1 is one run a row): what all budgets share is done once, each budget then gets the
// same placement, to the byte, as `place` would give it alone.
//
//   scene ─▶ survey ─▶ budgets, loose to tight: { problem views ─▶ candidates ─▶ selection ⇄ baking ─▶ point } ─▶ gates ─▶ files
//
// Shared are loading, visible sets, size models, the survey, all direction searches (search_memory.h) and the bakes that neighbouring
// budgets have in common (bake_memory.h). Selections start afresh at each budget: one that went on from the looser budget's would differ
// from what `place` gives, and selection takes the least of the seconds. Nothing is rendered: `place` verifies.
#pragma once

#include <filesystem>

#include "server/pipeline.h"

namespace standin {

/// Files a curve is held against; empty: none.
struct SweepGates {
  std::filesystem::path baseline;    // an earlier sweep.json
  std::filesystem::path acceptance;  // criteria
};

/// Budgets: those of the spec, of the acceptance criteria, or of the baseline; without any, some are chosen. The outcome's metrics are
/// sweep.json; its aim is met when no criterion and no comparison fails and no CPV is unsolved that the baseline or a criterion does not
/// put up with.
[[nodiscard]] JobOutcome run_sweep(const JobFiles& files, const SweepGates& gates, const JobSpec& spec, const WorkBudget& budget);

}  // namespace standin
