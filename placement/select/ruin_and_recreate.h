// Making a finished cover cheaper by taking part of it down and building that part again (Schrimpf et al. 2000; large neighbourhoods: Shaw
// 1998).
//
// Reverse-delete and exchange stop where no single member can go and no single addition pays. Here several members that share regions leave
// together; their regions are met again by a small greedy over all candidates that list them, at prices changed a little at random, and
// what that makes redundant goes. The new cover is kept when it has fewer bytes. One stage only: with several, antichains are searched for.
#pragma once

#include <cstdint>

#include "placement/select/cover.h"
#include "placement/select/selection_work.h"
#include "render/base/work.h"

namespace standin {

/// `cover`: every CPV that has an antichain assigned is met by it, and stays so. Returns the trials made, fewer than `trials` when the work
/// limit ended them.
std::uint64_t ruin_and_recreate(const SelectionProblem& problem, const TreeOrder& order, const Columns& columns, Cover& cover,
                                std::uint64_t trials, const WorkBudget& budget, SelectionWork& work);

}  // namespace standin
