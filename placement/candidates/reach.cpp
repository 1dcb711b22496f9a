// What the best impostors could do for each CPV, before anything is selected (simulation.md 8.5: feasibility first).
//
// Per cell, each visible cluster's tight impostor is drafted once; per CPV, V(node) = max(own gain, V(left) + V(right)) from the leaves up.
#include <algorithm>
#include <limits>

#include "placement/candidates/draft.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

constexpr std::size_t kBlockers = 5;

/// A cluster as one cell sees it. Children come after their parents.
struct SeenNode {
  std::uint32_t node = 0;
  std::vector<Cost> costs;  // of its tight impostors, by technique
  double value = 0.0;       // V(node) in the CPV at hand
  bool own = false;         // its impostor is what reaches V
};

class CellReach {
 public:
  CellReach(const DraftContext& context, std::uint32_t cell) : context_(context) {
    for (const std::uint32_t node : seen_nodes(cell)) {
      nodes_.push_back({node, {}});
      for (const Draft& draft : draft_candidates(context, node, {cell})) nodes_.back().costs.push_back(draft.cost);
    }
  }

  /// Greatest gain of disjoint impostors in the CPV.
  double best_gain_ms(const Cpv& cpv) {
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      SeenNode& seen = nodes_[i];
      const HierarchyNode& node = context_.hierarchy.nodes[seen.node];
      const double children_ms = value_of(node.left) + value_of(node.right);
      const double own_ms = own_gain_ms(seen, cpv);
      seen.own = own_ms > children_ms;
      seen.value = seen.own ? own_ms : children_ms;
    }
    return nodes_.empty() ? 0.0 : nodes_.front().value;
  }

  /// After best_gain_ms: the largest terms that no impostor stands for.
  [[nodiscard]] std::vector<std::uint32_t> blockers(const Cpv& cpv) const {
    std::vector<RegionTerm> left;
    for (std::uint64_t t = cpv.first_term; t < cpv.first_term + cpv.term_count; ++t)
      if (!is_replaced(context_.subdivision.terms[t].object)) left.push_back(context_.subdivision.terms[t]);
    std::sort(left.begin(), left.end(), [](const RegionTerm& a, const RegionTerm& b) {
      return a.predicted_ms != b.predicted_ms ? a.predicted_ms > b.predicted_ms : a.object < b.object;
    });
    std::vector<std::uint32_t> objects;
    for (std::size_t i = 0; i < std::min(left.size(), kBlockers); ++i) objects.push_back(left[i].object);
    return objects;
  }

 private:
  /// Of the technique that gains most; 0 where none is possible.
  [[nodiscard]] double own_gain_ms(const SeenNode& seen, const Cpv& cpv) const {
    if (seen.costs.empty()) return 0.0;
    double least_ms = std::numeric_limits<double>::infinity();
    for (const Cost& cost : seen.costs) least_ms = std::min(least_ms, in_form(cost, cpv));
    return context_.index.terms_ms(cpv, seen.node) - least_ms;
  }

  /// Nodes with a visible object, ascending (parents first).
  [[nodiscard]] std::vector<std::uint32_t> seen_nodes(std::uint32_t cell) const {
    std::vector<std::uint32_t> nodes;
    for (const std::uint32_t rank : context_.index.visible(cell)) {
      auto node = static_cast<std::int32_t>(context_.hierarchy.leaf[context_.hierarchy.order[rank]]);
      for (; node >= 0; node = context_.hierarchy.nodes[static_cast<std::size_t>(node)].parent)
        nodes.push_back(static_cast<std::uint32_t>(node));
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }

  [[nodiscard]] const SeenNode* find(std::int32_t node) const {
    if (node < 0) return nullptr;
    const auto at = std::lower_bound(nodes_.begin(), nodes_.end(), static_cast<std::uint32_t>(node),
                                     [](const SeenNode& seen, std::uint32_t id) { return seen.node < id; });
    return at != nodes_.end() && at->node == static_cast<std::uint32_t>(node) ? &*at : nullptr;
  }

  [[nodiscard]] double value_of(std::int32_t node) const {
    const SeenNode* seen = find(node);
    return seen != nullptr ? seen->value : 0.0;
  }

  /// Whether an impostor on the way from the object to the root is in use: an own node replaces whatever lies below it.
  [[nodiscard]] bool is_replaced(std::uint32_t object) const {
    auto node = static_cast<std::int32_t>(context_.hierarchy.leaf[object]);
    for (; node >= 0; node = context_.hierarchy.nodes[static_cast<std::size_t>(node)].parent)
      if (const SeenNode* seen = find(node); seen != nullptr && seen->own) return true;
    return false;
  }

  const DraftContext& context_;
  std::vector<SeenNode> nodes_;
};

}  // namespace

Reach reachable_times(const Scene& scene, const Hierarchy& hierarchy, const Subdivision& subdivision, const TimeModel& model,
                      const SizeModels& sizes, const Camera& camera, const BakeQuality& quality, const CandidateOptions& options,
                      const WorkBudget& budget) {
  const CellIndex index(hierarchy, subdivision);
  const ObjectOutlines outlines(scene);
  const DraftContext context{scene, hierarchy, subdivision, index, outlines, model, sizes, camera, quality, options.shape};
  Reach reach;
  reach.predicted_ms.resize(subdivision.cpvs.size());
  reach.blockers.resize(subdivision.cpvs.size());
  parallel_for(subdivision.cells.size(), options.threads, budget, [&](std::size_t cell) {
    const IdRange cpvs = index.cpvs(static_cast<std::uint32_t>(cell));
    if (cpvs.begin == cpvs.end) return;
    CellReach from_cell(context, static_cast<std::uint32_t>(cell));
    for (std::uint32_t p = cpvs.begin; p < cpvs.end; ++p) {
      reach.predicted_ms[p] = subdivision.cpvs[p].predicted_ms - from_cell.best_gain_ms(subdivision.cpvs[p]);
      reach.blockers[p] = from_cell.blockers(subdivision.cpvs[p]);
    }
  });
  return reach;
}

}  // namespace standin
