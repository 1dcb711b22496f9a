// What the greedy knows while it picks: residual deficits, and what represents each cluster in each CPV.
//
// Score of a candidate (thesis Eq. 5.4-5.6, as Wolsey's truncated sum; math.md 5.3):
//     score = (1 / bytes) sum over CPVs p, stages k of  min(max(net, 0), max(residual, 0)),   net = gain - gain of what it would replace
// and a CPV takes part only if net >= 0 in *every* stage (the safe rule) and no ancestor's impostor is in use there. Then no score can
// rise, which is what lets the lazy greedy trust stale scores. That must hold after rounding too, or lazy and plain would differ:
//   - min(max(net, 0), max(residual, 0)) is monotone in both; the textbook form max(0, r) - max(0, r - net) is not;
//   - residuals are only ever lowered by net >= 0;
//   - what represents a cluster is the sum of all nets ever accepted inside it, in the order of the tree. Accepting one more inserts a term
//     >= 0 into a left-to-right sum, which never falls, rounded or not. Summing the active gains afresh could fall by an ulp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/serving.h"
#include "placement/select/tree_order.h"

namespace standin {

class GreedyState {
 public:
  /// CPVs with `ignored[p]` (P flags, or empty) count as met.
  GreedyState(const SelectionProblem& problem, const TreeOrder& order, const std::vector<bool>& ignored);

  /// Puts an antichain of one CPV to use, where nothing is in use yet, whatever its gains (what is baked already).
  void represent(std::span<const Serving> antichain);

  [[nodiscard]] double score(std::uint32_t candidate) const;
  /// Uses the candidate wherever its score comes from.
  void take(std::uint32_t candidate);

  [[nodiscard]] bool all_met() const { return unmet_ == 0; }

 private:
  /// A net that was accepted, and where the impostor ends that stands for its cluster now: that one, or a larger one accepted since.
  struct Accepted {
    std::uint32_t rank = 0;       // of the node
    std::uint32_t used_last = 0;  // last rank of the node in use
  };
  struct Cpv {
    std::vector<Accepted> accepted;  // by rank; each lies inside the node of an impostor in use
    std::vector<double> net;         // `stages` values for each
  };
  /// The part of `accepted` inside a node.
  struct Range {
    std::size_t begin = 0, end = 0;
    bool ancestor_in_use = false;
  };

  [[nodiscard]] bool is_met(std::uint32_t cpv) const;
  [[nodiscard]] Range inside(const Cpv& state, std::uint32_t node) const;
  [[nodiscard]] double net(const Cpv& state, const Range& range, const Serving& serving, std::uint32_t stage) const;
  [[nodiscard]] double term(const Serving& serving) const;
  void use(const Serving& serving);

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  std::vector<double> residual_;  // P * K
  std::vector<bool> met_;
  std::vector<bool> touched_;  // something is in use: most scores are taken before, and need not look
  std::vector<Cpv> cpvs_;
  std::uint32_t unmet_ = 0;
};

}  // namespace standin
