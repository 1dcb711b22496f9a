// Who serves a CPV: the gain matrix by columns.
//
// Columns list their candidates by (rank of the node, candidate id), so that a node's whole subtree is contiguous and comes after it: the
// order in which the tree DP wants them. An entry points into SelectionProblem::cpv and ::gain.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/selection_problem.h"
#include "placement/select/tree_order.h"

namespace standin {

struct Serving {
  std::uint32_t candidate = 0;
  std::uint32_t entry = 0;
};

class Columns {
 public:
  Columns(const SelectionProblem& problem, const TreeOrder& order);

  [[nodiscard]] std::span<const Serving> of(std::uint32_t cpv) const {
    return {servings_.data() + offset_[cpv], servings_.data() + offset_[cpv + 1]};
  }

 private:
  std::vector<std::uint64_t> offset_;
  std::vector<Serving> servings_;
};

/// Throws Failure(kBadUsage) naming the row for a problem that breaks the layout of selection_problem.h.
void validate(const SelectionProblem& problem);

}  // namespace standin
