#include "placement/select/greedy.h"

#include <algorithm>

#include "render/base/parallel.h"

namespace standin {
namespace {

struct Scored {
  double score = 0.0;
  std::uint32_t candidate = 0;
};

/// Whether `b` is the better pick: greater score, then lower id (the order of a max-heap).
bool worse(const Scored& a, const Scored& b) {
  return a.score != b.score ? a.score < b.score : a.candidate > b.candidate;
}

constexpr std::size_t kChunk = 4096;  // candidates a task

/// All scores before the first pick; 0 for those with `taken`. Most of the greedy's work.
std::vector<double> first_scores(const GreedyState& state, const std::vector<bool>& taken, int threads, const WorkBudget& budget) {
  std::vector<double> scores(taken.size(), 0.0);
  parallel_for((taken.size() + kChunk - 1) / kChunk, threads, budget, [&](std::size_t chunk) {
    const std::size_t end = std::min(taken.size(), (chunk + 1) * kChunk);
    for (std::size_t c = chunk * kChunk; c < end; ++c)
      if (!taken[c]) scores[c] = state.score(static_cast<std::uint32_t>(c));
  });
  return scores;
}

}  // namespace

GreedyPicks pick_lazily(GreedyState& state, const std::vector<bool>& taken, int threads, const WorkBudget& budget) {
  SelectionWork without_limit;
  return pick_lazily(state, taken, threads, budget, without_limit);
}

GreedyPicks pick_lazily(GreedyState& state, const std::vector<bool>& taken, int threads, const WorkBudget& budget, SelectionWork& work) {
  GreedyPicks picks;
  if (state.all_met()) return picks;
  picks.evaluations = static_cast<std::uint64_t>(std::ranges::count(taken, false));
  for (std::uint32_t c = 0; c < taken.size(); ++c)
    if (!taken[c]) work.spend(state.listed(c));
  std::vector<Scored> heap;
  const auto scores = first_scores(state, taken, threads, budget);
  for (std::uint32_t c = 0; c < scores.size(); ++c)
    if (scores[c] > 0.0) heap.push_back({scores[c], c});
  std::make_heap(heap.begin(), heap.end(), worse);
  const auto score = [&](std::uint32_t candidate) {
    if (++picks.evaluations % 4096 == 0) budget.check();
    work.spend(state.listed(candidate));
    return state.score(candidate);
  };

  while (!state.all_met() && !heap.empty()) {
    if (work.exhausted()) {
      picks.cut_short = true;
      break;
    }
    std::pop_heap(heap.begin(), heap.end(), worse);
    const Scored top{score(heap.back().candidate), heap.back().candidate};
    heap.pop_back();
    if (top.score <= 0.0) continue;
    if (heap.empty() || worse(heap.front(), top)) {
      state.take(top.candidate);
      picks.order.push_back(top.candidate);
    } else {
      heap.push_back(top);
      std::push_heap(heap.begin(), heap.end(), worse);
    }
  }
  return picks;
}

GreedyPicks pick_plainly(GreedyState& state, const std::vector<bool>& taken, const WorkBudget& budget) {
  GreedyPicks picks;
  std::vector<bool> left_alone = taken;
  while (!state.all_met()) {
    budget.check();
    Scored best;
    for (std::uint32_t c = 0; c < left_alone.size(); ++c) {
      if (left_alone[c]) continue;
      ++picks.evaluations;
      if (const Scored fresh{state.score(c), c}; fresh.score > best.score) best = fresh;
    }
    if (best.score <= 0.0) break;
    state.take(best.candidate);
    picks.order.push_back(best.candidate);
    left_alone[best.candidate] = true;
  }
  return picks;
}

}  // namespace standin
