// Greedy picking, lazily (thesis 5.7.3-5.7.4) or plainly.
//
// A stale score is an upper bound (greedy_state.h), so only the top of the heap is scored again; when it stays the top, it is the best of
// all. Both ways pick the same candidates in the same order, bit for bit: by score, ties by lower id.
#pragma once

#include <cstdint>
#include <vector>

#include "placement/select/greedy_state.h"
#include "placement/select/selection_work.h"
#include "render/base/work.h"

namespace standin {

struct GreedyPicks {
  std::vector<std::uint32_t> order;  // in the order they were picked
  std::uint64_t evaluations = 0;
  bool cut_short = false;  // by the work limit
};

/// Picks until every CPV is met or no score is positive (a stall; stall_repair.h). Candidates with `taken` are left alone.
[[nodiscard]] GreedyPicks pick_lazily(GreedyState& state, const std::vector<bool>& taken, int threads, const WorkBudget& budget,
                                      SelectionWork& work);
[[nodiscard]] GreedyPicks pick_lazily(GreedyState& state, const std::vector<bool>& taken, int threads, const WorkBudget& budget);
/// The oracle: scores every candidate before every pick.
[[nodiscard]] GreedyPicks pick_plainly(GreedyState& state, const std::vector<bool>& taken, const WorkBudget& budget);

}  // namespace standin
