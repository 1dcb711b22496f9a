// A lower bound on the bytes of any solution (math.md 5.5).
//
// Drop the antichain condition and allow fractions: min m.y subject to sum_i a_iq y_i >= D_q, 0 <= y <= 1, with q = (CPV, stage) and a_iq =
// min(max(g_iq, 0), D_q). For ANY multipliers lambda >= 0,
//     L(lambda) = sum_q D_q lambda_q + sum_i min(0, m_i - sum_q a_iq lambda_q)  <=  bytes of any feasible set,
// so the search for good multipliers needs no proof of its own. It starts by dual ascent (raise one multiplier until a candidate is paid
// for in full) and goes on by a deflected subgradient (Camerini, Fratta, Maffioli 1975; step rule of Held, Wolfe, Crowder 1974). Every step
// is one pass over the gains: the bound improves with time, and any prefix of it is valid. It is weak where a cluster has many overlapping
// shafts: the relaxation may count several impostors of one cluster in the same CPV.
#pragma once

#include <vector>

#include "placement/select/serving.h"
#include "render/base/work.h"

namespace standin {

/// Rows of CPVs with `ignored[p]` are dropped. `upper_bound_bytes`: of a known solution (it scales the steps). On very large problems fewer
/// steps than `iterations` are made. 0 iterations: the ascent alone. Rounding is charged to the bound, so it is never above the optimum.
/// The same for any number of threads.
[[nodiscard]] double lagrangian_bound(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored,
                                      double upper_bound_bytes, int iterations, int threads, const WorkBudget& budget);

}  // namespace standin
