// Solving the CPVs at which the greedy stalls.
//
// An impostor of a large cluster locks its descendants out, so the safe greedy can stop short of a solution that exists (math.md 0, F6; 14
// of 144 small random instances, 2-50 CPVs of a city). For such a CPV the best antichain over all candidates is known to suffice: its
// missing members are added, cheapest per gain first, until S holds an antichain that does.
#pragma once

#include "placement/select/cover.h"

namespace standin {

/// `best`: an antichain that meets the CPV.
void repair_stall(const SelectionProblem& problem, Cover& cover, std::uint32_t cpv, const Antichain& best);

}  // namespace standin
