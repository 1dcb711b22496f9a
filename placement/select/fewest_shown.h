// Showing no more impostors than a region needs (thesis 5.8.2, over-conservativeness).
//
// The selection uses whatever helps most in each region, since what is paid for is there. Where that exceeds the deficit, some of it can
// stay away: originals look better than impostors, and fewer nodes are swapped as a viewer moves on. Of the antichains of the chosen set
// that meet a region, one with the fewest members is shown; of these, the one that gains most. No bytes change.
//
// One stage: a tree DP over the number of members, G(node)[k] = greatest gain of an antichain of k members inside the node. Several stages:
// members are left out one after the other, those that gain least first, as long as the region stays met; that need not be the fewest.
#pragma once

#include <cstdint>

#include "placement/select/selection_problem.h"

namespace standin {

struct ShownImpostors {
  std::uint64_t before = 0;  // members of all antichains together
  std::uint64_t after = 0;
};

/// Regions that their antichain does not meet keep it.
ShownImpostors show_fewest(const SelectionProblem& problem, Selection& selection, const WorkBudget& budget);

}  // namespace standin
