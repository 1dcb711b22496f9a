#include "placement/view_space/direction_search.h"

#include <algorithm>

namespace standin {
namespace {

struct Node {
  DirectionInterval interval;
  std::vector<std::uint32_t> seen;  // indices into CellCosts::objects, ascending: hierarchy order
  std::vector<Cost> costs;          // of these, at most
  RegionSums sums;
};

class Search {
 public:
  Search(const RegionEstimator& estimator, CellCosts& cell, double budget_ms, const DirectionSearchResult* looser)
      : estimator_(estimator), cell_(cell), budget_ms_(budget_ms), looser_(looser) {
    result_.worst_predicted_ms = looser != nullptr ? looser->worst_predicted_ms : -1.0;
    if (looser != nullptr) result_.worst_interval = looser->worst_interval;
  }

  DirectionSearchResult run() {
    Node all;
    for (std::uint32_t i = 0; i < cell_.objects.size(); ++i) {
      all.seen.push_back(i);
      all.costs.push_back(cell_.objects[i].cost);
    }
    std::vector<Node> faces;
    for (int face = 0; face < kFaceCount; ++face) faces.push_back(make_node({static_cast<Face>(face), 0, 0, 0}, all));
    visit(faces);
    if (estimator_.by_view()) result_.worst_predicted_ms = std::max(result_.worst_predicted_ms, within_budget_ms_);
    std::ranges::sort(result_.hot, {}, &HotRegion::interval);
    result_.terms.shrink_to_fit();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Node make_node(const DirectionInterval& interval, const Node& parent) const {
    Node node{interval, {}, {}, estimator_.empty_frame()};
    for (std::size_t k = 0; k < parent.seen.size(); ++k) {
      if (!estimator_.may_see(interval, cell_, cell_.objects[parent.seen[k]].bounds)) continue;
      node.seen.push_back(parent.seen[k]);
      node.costs.push_back(parent.costs[k]);
      node.sums.add(parent.costs[k]);
    }
    return node;
  }

  // By view, what is within the budget is not looked at: bounds prune little above what sampled views take.
  [[nodiscard]] double threshold_ms() const { return estimator_.by_view() ? budget_ms_ : std::min(budget_ms_, result_.worst_predicted_ms); }

  // Highest bound first, so that the worst region is met early and prunes the rest.
  void visit(std::vector<Node>& siblings) {
    std::stable_sort(siblings.begin(), siblings.end(),
                     [](const Node& a, const Node& b) { return a.sums.predicted_ms() > b.sums.predicted_ms(); });
    for (Node& node : siblings) {
      if (node.sums.predicted_ms() <= threshold_ms()) {
        within_budget_ms_ = std::max(within_budget_ms_, node.sums.predicted_ms());
        return;
      }
      if (node.interval.level == estimator_.leaf_level(cell_))
        take_leaf(node);
      else if (node.interval.level < estimator_.first_sharp_level(cell_) || is_above(node))
        visit_children(node);
    }
  }

  [[nodiscard]] bool is_above(Node& node) { return estimator_.sharpen(cell_, node.interval, node.seen, node.costs, threshold_ms()); }

  void visit_children(const Node& node) {
    std::vector<Node> children;
    for (int k = 0; k < 4; ++k) children.push_back(make_node(node.interval.child(k), node));
    visit(children);
  }

  void take_leaf(Node& leaf) {
    if (const HotRegion* known = known_region(leaf.interval)) return result_.add(*known, looser_->terms_of(*known));
    if (!is_above(leaf)) return;
    const RegionBound bound = estimator_.bound_of(cell_, leaf.seen, leaf.costs);
    if (bound.predicted_ms > result_.worst_predicted_ms) {
      result_.worst_predicted_ms = bound.predicted_ms;
      result_.worst_interval = leaf.interval;
    }
    if (bound.predicted_ms > budget_ms_)
      result_.add({leaf.interval, bound.pixels_capped, bound.constant_ms, bound.predicted_ms}, bound.terms);
  }

  [[nodiscard]] const HotRegion* known_region(const DirectionInterval& interval) const {
    if (looser_ == nullptr) return nullptr;
    const auto at = std::ranges::lower_bound(looser_->hot, interval, {}, &HotRegion::interval);
    return at != looser_->hot.end() && at->interval == interval ? &*at : nullptr;
  }

  const RegionEstimator& estimator_;
  CellCosts& cell_;
  double budget_ms_;
  double within_budget_ms_ = 0.0;  // greatest bound of what was pruned by it
  const DirectionSearchResult* looser_;
  DirectionSearchResult result_;
};

}  // namespace

void DirectionSearchResult::add(HotRegion region, std::span<const RegionTerm> its_terms) {
  region.first_term = terms.size();
  region.term_count = its_terms.size();
  hot.push_back(region);
  terms.insert(terms.end(), its_terms.begin(), its_terms.end());
}

DirectionSearchResult search_directions(const RegionEstimator& estimator, CellCosts& cell, double predicted_budget_ms,
                                        const DirectionSearchResult* looser) {
  return Search(estimator, cell, predicted_budget_ms, looser).run();
}

DirectionSearchResult at_looser_budget(const DirectionSearchResult& found, double predicted_budget_ms) {
  DirectionSearchResult loose;
  loose.worst_predicted_ms = found.worst_predicted_ms;
  loose.worst_interval = found.worst_interval;
  for (const HotRegion& region : found.hot)
    if (region.predicted_ms > predicted_budget_ms) loose.add(region, found.terms_of(region));
  return loose;
}

}  // namespace standin
