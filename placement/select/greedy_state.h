// What the greedy knows while it picks: residual deficits, and what represents each cluster in each CPV.
//
// Score of a candidate (thesis Eq. 5.4-5.6, as Wolsey's truncated sum; math.md 5.3):
//     score = (1 / bytes) sum over CPVs p, stages k of  min(max(net, 0), max(residual, 0)),   net = gain - gain of what it would replace
// and a CPV takes part only if net >= 0 in *every* stage (the safe rule) and no ancestor's impostor is in use there. Then no score can
// rise, which is what lets the lazy greedy trust stale scores. That must hold after rounding too, or lazy and plain would differ:
//   - min(max(net, 0), max(residual, 0)) is monotone in both; the textbook form max(0, r) - max(0, r - net) is not;
//   - residuals are only ever lowered by net >= 0;
//   - what represents a cluster is the sum of all nets ever accepted inside it, each >= 0, added as they come: such a sum never falls,
//   rounded
//     or not. Summing the active gains afresh could.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/serving.h"

namespace standin {

class GreedyState {
 public:
  /// CPVs with `ignored[p]` (P flags, or empty) count as met. `price`: what scores are divided by, per candidate, > 0; the bytes when
  /// empty.
  GreedyState(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored, std::vector<double> price = {});

  /// Puts an antichain of one CPV to use, where nothing is in use yet, whatever its gains (what is baked already).
  void represent(std::span<const Serving> antichain);

  [[nodiscard]] double score(std::uint32_t candidate) const;
  /// Uses the candidate wherever its score comes from.
  void take(std::uint32_t candidate);

  /// Gains that a score looks at.
  [[nodiscard]] std::uint64_t listed(std::uint32_t candidate) const { return problem_.listed(candidate); }
  [[nodiscard]] bool all_met() const { return unmet_ == 0; }

 private:
  [[nodiscard]] bool is_met(std::uint32_t cpv) const;
  [[nodiscard]] double net(std::uint32_t candidate, std::uint32_t entry, std::uint32_t stage) const {
    return problem_.gain(candidate, entry, stage) - represented_[static_cast<std::size_t>(entry) * problem_.stages + stage];
  }
  [[nodiscard]] double term(std::uint32_t candidate, std::uint32_t entry) const;
  void use(const Serving& serving);

  const SelectionProblem& problem_;
  const Columns& columns_;
  std::vector<double> price_;
  std::vector<double> residual_;     // P * K
  std::vector<double> represented_;  // per entry * K: sum of the nets accepted inside; infinite below an impostor in use
  std::uint32_t unmet_ = 0;
};

}  // namespace standin
