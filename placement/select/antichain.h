// The best set of disjoint impostors for one CPV.
//
// One stage: a tree DP, V(node) = max(best own gain, sum of V(children)), linear in the number of candidates. Several stages: branch and
// bound for the least violation, with the DP of each stage alone as the optimistic bound; small by construction (a CPV of a max-of-stages
// model), and cut off after a fixed number of steps.
//
// An antichain meets its CPV when its gains add up to the deficit in every stage. These sums are carried in extended precision, in which
// up to 2,000 doubles of like size add exactly: whether a deficit is met does not depend on the order of addition, and the DP never prefers
// an antichain by a rounding error.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/serving.h"

namespace standin {

inline constexpr std::uint32_t kNoCandidate = UINT32_MAX;
using GainSum = long double;

struct Antichain {
  std::vector<Serving> members;  // by candidate id
  double violation = 0.0;        // sum over stages of what is missing; 0 iff it meets the CPV
  [[nodiscard]] bool meets() const { return violation == 0.0; }
};

/// Keeps scratch memory between calls; one per thread.
class AntichainFinder {
 public:
  AntichainFinder(const SelectionProblem& problem, const TreeOrder& order) : problem_(problem), order_(order) {}

  /// `servings`: of this CPV, by rank of the node. Greatest gain (one stage) or least violation (several), ties to the larger cluster,
  /// then fewer bytes, then the lower id. `without` is left out.
  [[nodiscard]] Antichain best(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t without = kNoCandidate);

 private:
  /// The part of a column that belongs to one node.
  struct Group {
    std::uint32_t last_rank = 0;
    Serving best;
    bool own = false;  // its own impostor beats the children's
  };
  struct Subtree {
    std::uint32_t rank = 0;
    GainSum value = 0.0L;
  };

  void best_by_tree(std::span<const Serving> servings, std::uint32_t without);
  void choose_greatest(std::vector<Serving>& chosen) const;
  void search_stages(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t without);
  void bound_suffixes();
  [[nodiscard]] GainSum missing(const GainSum* gained, const GainSum* further, std::uint32_t cpv) const;
  [[nodiscard]] Antichain evaluated(std::vector<Serving> chosen, std::uint32_t cpv) const;
  [[nodiscard]] std::uint32_t rank(const Serving& s) const { return order_.first(problem_.node[s.candidate]); }
  [[nodiscard]] std::uint32_t last_rank(const Serving& s) const { return order_.last(problem_.node[s.candidate]); }
  [[nodiscard]] double gain(const Serving& s, std::uint32_t stage) const { return problem_.gain(s.candidate, s.entry, stage); }

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  std::vector<Group> groups_;     // in reverse rank order
  std::vector<Subtree> tops_;     // subtrees not yet inside a processed node
  std::vector<Serving> allowed_;  // several stages: the column without what is left out
  std::vector<GainSum> suffix_;   // several stages: greatest gain of allowed_[i..] per stage
  std::vector<Serving> chosen_;   // result of either search
};

}  // namespace standin
