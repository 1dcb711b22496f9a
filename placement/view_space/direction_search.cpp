#include "placement/view_space/direction_search.h"

#include <algorithm>

namespace standin {
namespace {

struct Node {
  DirectionInterval interval;
  std::vector<std::uint32_t> seen;  // indices into CellCosts::objects, ascending: hierarchy order
  RegionSums sums;
};

class Search {
 public:
  Search(const RegionEstimator& estimator, CellCosts& cell, double budget_ms) : estimator_(estimator), cell_(cell), budget_ms_(budget_ms) {
    result_.worst_predicted_ms = -1.0;
  }

  DirectionSearchResult run() {
    std::vector<std::uint32_t> all(cell_.objects.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<Node> faces;
    for (int face = 0; face < kFaceCount; ++face) faces.push_back(make_node({static_cast<Face>(face), 0, 0, 0}, all));
    visit(faces);
    std::sort(result_.hot.begin(), result_.hot.end(), [](const HotRegion& a, const HotRegion& b) { return a.interval < b.interval; });
    return std::move(result_);
  }

 private:
  [[nodiscard]] Node make_node(const DirectionInterval& interval, const std::vector<std::uint32_t>& parent_seen) const {
    Node node{interval, {}, estimator_.empty_frame()};
    for (const std::uint32_t i : parent_seen) {
      if (!estimator_.may_see(interval, cell_, cell_.objects[i].bounds)) continue;
      node.seen.push_back(i);
      node.sums.add(cell_.objects[i].cost);
    }
    return node;
  }

  // Highest bound first, so that the worst region is met early and prunes the rest.
  void visit(std::vector<Node>& siblings) {
    std::stable_sort(siblings.begin(), siblings.end(),
                     [](const Node& a, const Node& b) { return a.sums.predicted_ms() > b.sums.predicted_ms(); });
    for (const Node& node : siblings) {
      const double predicted_ms = node.sums.predicted_ms();
      if (predicted_ms <= budget_ms_ && predicted_ms <= result_.worst_predicted_ms) return;
      if (node.interval.level == estimator_.directions().leaf_level()) {
        take_leaf(node);
        continue;
      }
      std::vector<Node> children;
      for (int k = 0; k < 4; ++k) children.push_back(make_node(node.interval.child(k), node.seen));
      visit(children);
    }
  }

  void take_leaf(const Node& leaf) {
    const auto sums = estimator_.sums_above(cell_, leaf.interval, leaf.seen, std::min(budget_ms_, result_.worst_predicted_ms));
    if (!sums) return;
    const double predicted_ms = sums->predicted_ms();
    if (predicted_ms > result_.worst_predicted_ms) {
      result_.worst_predicted_ms = predicted_ms;
      result_.worst_interval = leaf.interval;
    }
    if (predicted_ms <= budget_ms_) return;
    result_.hot.push_back({leaf.interval, predicted_ms, result_.seen.size(), leaf.seen.size()});
    result_.seen.insert(result_.seen.end(), leaf.seen.begin(), leaf.seen.end());
  }

  const RegionEstimator& estimator_;
  CellCosts& cell_;
  double budget_ms_;
  DirectionSearchResult result_;
};

}  // namespace

DirectionSearchResult search_directions(const RegionEstimator& estimator, CellCosts& cell, double predicted_budget_ms) {
  return Search(estimator, cell, predicted_budget_ms).run();
}

}  // namespace standin
