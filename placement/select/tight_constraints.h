// Which constraints a lower bound looks at first: those in which a known solution has least to spare.
//
// A constraint q = (CPV, stage) in which a member of the solution can hardly be done without is what makes the solution pay for it. Most
// others are met along the way: a bound that looks at them spends its time on bytes that nobody needs. Any part of the constraints bounds
// the whole (lagrangian_bound.h), so which of them are looked at is a matter of the bound's quality alone.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "placement/select/serving.h"

namespace standin {

class TightConstraints {
 public:
  explicit TightConstraints(const SelectionProblem& problem) : problem_(problem), uses_(problem.candidate_count()) {}

  /// `antichain`: what the known solution shows there.
  void see(std::uint32_t cpv, const std::vector<Serving>& antichain);
  /// Once all are seen: of each member the constraints that use it, tightest first.
  void sort();
  /// The `count` tightest of each member, each once: the tightest of all first.
  [[nodiscard]] std::vector<std::uint32_t> tightest(std::size_t count) const;
  /// Of the member that has most.
  [[nodiscard]] std::size_t most() const;

 private:
  struct Use {
    double coverage = 0.0;  // of the deficit, by the whole antichain
    std::uint32_t constraint = 0;
    friend auto operator<=>(const Use&, const Use&) = default;
  };

  const SelectionProblem& problem_;
  std::vector<std::vector<Use>> uses_;  // per candidate
};

}  // namespace standin
