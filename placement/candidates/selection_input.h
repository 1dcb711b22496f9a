// From regions and candidates to the covering problem: the last place where geometry is seen.
//
// CPV p of the problem is Subdivision::cpvs[p]; row c is candidate c. One stage. In milliseconds of predicted time:
//     deficit[p]  = predicted[p] - (budget - reserve)
//     gain[c, p]  = terms of the node's objects in p  -  cost of drawing impostor c, in p's linear form       (kept where > 0)
// Gains are against the originals, so those of disjoint clusters add up.
#pragma once

#include <optional>
#include <vector>

#include "placement/candidates/candidates.h"
#include "placement/select/selection_problem.h"

namespace standin {

/// What is known of a candidate once it is baked.
struct BakedSize {
  double bytes = 0.0;  // > 0
  ImpostorCost cost;
};

struct SelectionBudget {
  double predicted_ms = 0.0;  // TimeModel::predicted_budget_ms
  double reserve_ms = 0.0;    // kept free in every CPV: switches to the atlas pages
};

/// `baked`: per candidate, or empty; overrides the estimates. The same result for any number of threads.
[[nodiscard]] SelectionProblem make_selection_problem(const Hierarchy& hierarchy, const Subdivision& subdivision,
                                                      const CandidateSet& candidates, const std::vector<std::optional<BakedSize>>& baked,
                                                      const TimeModel& model, const Camera& camera, const SelectionBudget& budget,
                                                      int threads, const WorkBudget& work);

}  // namespace standin
