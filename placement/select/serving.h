// Who serves a CPV: the gain matrix by columns, as factored as the matrix itself.
//
// A column lists its servings by (rank of the node, block, candidate id), so that a node's whole subtree is contiguous and comes after it:
// the order in which the tree DP wants them. Written out, all columns together would be as large as all gains: what is kept is which blocks
// hold a CPV and which candidates a block has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/selection_problem.h"
#include "placement/select/tree_order.h"

namespace standin {

/// A candidate at one of the CPVs it serves.
struct Serving {
  std::uint32_t candidate = 0;
  std::uint32_t entry = 0;
  friend bool operator==(const Serving&, const Serving&) = default;
};

class Columns {
 public:
  Columns(const SelectionProblem& problem, const TreeOrder& order);

  /// Replaces `servings` by all of the CPV.
  void read(std::uint32_t cpv, std::vector<Serving>& servings) const;
  /// One stage: only the candidate of each block that gains most, i.e. costs least; ties to fewer bytes, then to the lower id. No antichain
  /// gains more than the best of these.
  void read_best(std::uint32_t cpv, std::vector<Serving>& servings) const;
  /// Calls visit(entry) for the CPV's entries of the node and its ancestors.
  template <class Visit>
  void for_each_around(std::uint32_t cpv, std::uint32_t node, Visit&& visit) const {
    const auto all = blocks(cpv);
    auto end = all.end();
    for (auto around = static_cast<std::int32_t>(node); around >= 0; around = problem_.parent[static_cast<std::size_t>(around)]) {
      const std::uint32_t rank = order_.first(static_cast<std::uint32_t>(around));
      const auto first = first_from(all.begin(), end, rank);
      for (auto at = first; at != end && rank_[*at] == rank; ++at) visit(entry(*at, cpv));
      end = first;
    }
  }
  /// Calls visit(entry) for the CPV's entries of the nodes below the node.
  template <class Visit>
  void for_each_below(std::uint32_t cpv, std::uint32_t node, Visit&& visit) const {
    const auto all = blocks(cpv);
    const std::uint32_t last = order_.last(node);
    for (auto at = first_from(all.begin(), all.end(), order_.first(node) + 1); at != all.end() && rank_[*at] <= last; ++at)
      visit(entry(*at, cpv));
  }
  /// Per candidate: whether it lists none of the CPVs.
  [[nodiscard]] std::vector<bool> candidates_without(std::span<const std::uint32_t> cpvs) const;
  /// How many candidates list the CPV.
  [[nodiscard]] std::uint64_t coverage(std::uint32_t cpv) const;

 private:
  using BlockIterator = std::span<const std::uint32_t>::iterator;

  void list_candidates();
  void list_blocks();
  void find_best();
  [[nodiscard]] std::span<const std::uint32_t> blocks(std::uint32_t cpv) const {
    return {block_.data() + block_offset_[cpv], block_.data() + block_offset_[cpv + 1]};
  }
  [[nodiscard]] std::span<const std::uint32_t> candidates(std::uint32_t block) const {
    return {candidate_.data() + candidate_offset_[block], candidate_.data() + candidate_offset_[block + 1]};
  }
  [[nodiscard]] std::uint32_t entry(std::uint32_t block, std::uint32_t cpv) const;
  [[nodiscard]] BlockIterator first_from(BlockIterator begin, BlockIterator end, std::uint32_t rank) const {
    return std::lower_bound(begin, end, rank, [this](std::uint32_t block, std::uint32_t value) { return rank_[block] < value; });
  }

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  std::vector<std::uint64_t> candidate_offset_;  // per block + 1
  std::vector<std::uint32_t> candidate_;         // ascending within a block
  std::vector<std::uint32_t> rank_;              // per block: of its node
  std::vector<std::uint64_t> block_offset_;      // per CPV + 1
  std::vector<std::uint32_t> block_;             // by rank within a CPV
  std::vector<std::uint32_t> best_;              // one stage: blocks * forms
};

/// Throws Failure(kBadUsage) naming the place in a problem that breaks the layout of selection_problem.h.
void validate(const SelectionProblem& problem);

}  // namespace standin
