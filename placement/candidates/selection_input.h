// From regions and candidates to the covering problem: the last place where geometry is seen.
//
// CPV p of the problem is Subdivision::cpvs[p]; candidate c is CandidateSet::candidates[c]. One stage, two forms: 0 counts an impostor's
// pixels, 1 does not, since the region's pixels are capped. In milliseconds of predicted time:
//     deficit[p]      = predicted[p] - (budget - reserve)
//     worth[node, p]  = terms of the node's objects in p
//     cost[c, form]   = of drawing impostor c
// Gains are against the originals, so those of disjoint clusters add up.
#pragma once

#include "placement/candidates/candidates.h"
#include "placement/select/selection_problem.h"

namespace standin {

struct SelectionBudget {
  double predicted_ms = 0.0;  // TimeModel::predicted_budget_ms
  double reserve_ms = 0.0;    // kept free in every CPV: switches to the atlas pages
};

/// With the sizes and costs that the candidates estimate, without margins. Where nothing gains by these, no entry is kept. The same result
/// for any number of threads.
[[nodiscard]] SelectionProblem make_selection_problem(const Hierarchy& hierarchy, const Subdivision& subdivision,
                                                      const CandidateSet& candidates, const TimeModel& model, const Camera& camera,
                                                      const SelectionBudget& budget, int threads, const WorkBudget& work);

/// Another budget for the same candidates.
void set_budget(SelectionProblem& problem, const Subdivision& subdivision, const SelectionBudget& budget);
/// What has become known of a candidate.
void set_impostor(SelectionProblem& problem, std::uint32_t candidate, double bytes, const ImpostorCost& cost, const TimeModel& model,
                  const Camera& camera);
/// The candidate gains nowhere.
void rule_out(SelectionProblem& problem, std::uint32_t candidate);

}  // namespace standin
