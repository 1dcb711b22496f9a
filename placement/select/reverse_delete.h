// Dropping what is no longer needed (math.md 5.4).
//
// The greedy's early picks are often made redundant by later ones: in a city, reverse-delete drops 31-46 % of the picks and about 10 % of
// the memory. Exchange goes further, slowly: add one unused candidate, drop others, keep the change if memory fell.
#pragma once

#include "placement/select/cover.h"
#include "placement/select/selection_work.h"
#include "render/base/work.h"

namespace standin {

/// Tries the members of `cover` once, by descending bytes (ties: lower id). What remains is minimal: no single member can go.
/// Returns false when the work limit ended it.
bool reverse_delete(const SelectionProblem& problem, Cover& cover, const WorkBudget& budget, SelectionWork& work);

/// Up to `rounds` passes over all candidates, fewer once a pass improves nothing. Keeps the cover minimal. Returns false when the work
/// limit ended it.
bool exchange(const SelectionProblem& problem, Cover& cover, int rounds, const WorkBudget& budget, SelectionWork& work);

}  // namespace standin
