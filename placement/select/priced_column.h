// One covering constraint with a price on each candidate: what the cheapest fractional antichain costs, and what each price is needed for.
//
// The constraint q = (CPV, stage) asks for its deficit; everything here is in units of it: coverage a = min(gain, deficit) / deficit in
// (0, 1] of a demand of 1. With prices c >= 0 on the candidates, the cheapest antichain with sum a >= 1, fractions allowed, costs
//     v = max over t >= 0 of  t - V(t),   V(node) = max(best own t a - c, sum of V(children), 0), V(t) summed over the roots
// (tree DP, antichain.h). v is concave and piecewise linear in the bid t; the search for the best t meets the tangents of two antichains,
// one on either side, until nothing lies above where they cross. A mixture of these two is the fractional optimum.
//
// Prices above t a - V(node) buy nothing: v stays the same, and the rest can be spent elsewhere. Where an impostor of a whole cluster beats
// its parts, the difference is given to the parts, in proportion to their best coverage: V rises to the potentials that settle() finds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/select/serving.h"

namespace standin {

class PricedColumn {
 public:
  /// The part of the column that belongs to one node.
  struct Group {
    std::uint32_t rank = 0;
    std::uint32_t last_rank = 0;
    std::uint32_t entry = 0;
    std::uint32_t begin = 0;  // into the column
    std::uint32_t end = 0;
    std::uint32_t kept_begin = 0;  // into kept_
    std::uint32_t kept_end = 0;
    std::uint32_t best = 0;   // position in the column
    std::uint32_t after = 0;  // the first group beyond its subtree
    double own = 0.0;         // of V
    double parts = 0.0;
    double potential = 0.0;  // bytes; >= V
  };
  struct Share {
    std::uint32_t position = 0;
    double share = 0.0;
  };

  PricedColumn(const SelectionProblem& problem, const TreeOrder& order) : problem_(problem), order_(order) {}

  /// `servings`: of the CPV, by rank (Columns::read). Prices are 0 until set.
  void load(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t stage);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(coverage_.size()); }
  [[nodiscard]] std::uint32_t candidate(std::uint32_t position) const { return candidate_[position]; }
  [[nodiscard]] double coverage(std::uint32_t position) const { return coverage_[position]; }
  [[nodiscard]] std::span<const Group> groups() const { return groups_; }
  [[nodiscard]] double price(std::uint32_t position) const { return price_[position]; }
  void set_price(std::uint32_t position, double bytes) { price_[position] = bytes; }

  /// Returns v and keeps its bid; `start`: a guess of the bid, or 0.
  double maximise(double start);
  [[nodiscard]] double bid() const { return bid_; }
  /// After maximise(): the fractional optimum.
  [[nodiscard]] std::vector<Share> optimum() const;
  /// After maximise(): finds the potentials.
  void settle();
  /// t - V(t) at the prices set.
  double value(double bid);
  /// The cost of the cheapest antichain without fractions, at least: coverages are rounded up to multiples of 1 / kUnits.
  double whole_value();

  [[nodiscard]] std::uint64_t looked_at() const { return looked_at_; }

 private:
  /// An antichain that is best at some bid.
  struct Line {
    double value = 0.0;
    double coverage = 0.0;
    double cost = 0.0;
    std::vector<std::uint32_t> members;
  };

  void find_subtrees();
  void drop_dominated();
  double sum_of_roots(double bid);
  void find_best(double bid, Line& line);
  [[nodiscard]] double first_bid() const;
  void share_out(std::uint32_t group);

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  std::vector<Group> groups_;  // by rank
  std::vector<std::uint32_t> candidate_;
  std::vector<double> coverage_;
  std::vector<double> price_;
  std::vector<std::uint32_t> kept_;      // of each group, those that no other covers more for less
  std::vector<std::uint32_t> complete_;  // groups of complete subtrees, the next by rank on top
  double bid_ = 0.0;
  Line low_, high_, middle_;
  std::uint64_t looked_at_ = 0;
};

}  // namespace standin
