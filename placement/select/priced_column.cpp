#include "placement/select/priced_column.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace standin {
namespace {

constexpr int kMostMeetings = 60;
constexpr int kMostRaises = 80;
constexpr double kRaise = 8.0;
constexpr std::ptrdiff_t kMostCompared = 64;  // of a node's undominated candidates
constexpr double kMet = 1.0 - 1e-12;          // of the demand: sums of coverages are rounded

constexpr std::size_t kUnits = 128;
using CostOfUnits = std::array<double, kUnits + 1>;  // least cost of at least so many units
constexpr double kNever = std::numeric_limits<double>::infinity();

std::size_t units(double coverage) {
  return std::min(kUnits, static_cast<std::size_t>(std::ceil(coverage * kUnits * (1.0 + 1e-12))));
}

CostOfUnits nothing() {
  CostOfUnits costs;
  costs.fill(kNever);
  costs[0] = 0.0;
  return costs;
}

void make_monotone(CostOfUnits& costs) {
  for (std::size_t u = kUnits; u > 0; --u) costs[u - 1] = std::min(costs[u - 1], costs[u]);
}

// More units than these cost more: all that matters of a monotone table, and few of its entries.
class Steps {
 public:
  explicit Steps(const CostOfUnits& costs) {
    for (std::size_t u = 0; u <= kUnits; ++u)
      if (costs[u] != kNever && (u == kUnits || costs[u + 1] != costs[u])) steps_[count_++] = u;
  }
  [[nodiscard]] const std::size_t* begin() const { return steps_.data(); }
  [[nodiscard]] const std::size_t* end() const { return steps_.data() + count_; }

 private:
  std::array<std::size_t, kUnits + 1> steps_;
  std::size_t count_ = 0;
};

CostOfUnits together(const CostOfUnits& a, const CostOfUnits& b) {
  CostOfUnits sum;
  sum.fill(kNever);
  const Steps steps_of_a(a), steps_of_b(b);
  for (const std::size_t i : steps_of_a)
    for (const std::size_t j : steps_of_b) {
      double& cost = sum[std::min(kUnits, i + j)];
      cost = std::min(cost, a[i] + b[j]);
    }
  make_monotone(sum);
  return sum;
}

}  // namespace

void PricedColumn::load(std::span<const Serving> servings, std::uint32_t cpv, std::uint32_t stage) {
  groups_.clear();
  candidate_.clear();
  coverage_.clear();
  const double deficit = problem_.deficit[static_cast<std::size_t>(cpv) * problem_.stages + stage];
  for (const Serving& s : servings) {
    const double gain = problem_.gain(s.candidate, s.entry, stage);
    if (!(gain > 0.0)) continue;
    const std::uint32_t node = problem_.node[s.candidate];
    if (groups_.empty() || groups_.back().entry != s.entry) {
      groups_.push_back({.rank = order_.first(node), .last_rank = order_.last(node), .entry = s.entry});
      groups_.back().begin = size();
    }
    candidate_.push_back(s.candidate);
    coverage_.push_back(std::min(gain, deficit) / deficit);
    groups_.back().end = size();
  }
  price_.assign(coverage_.size(), 0.0);
  find_subtrees();
}

// Of one node's candidates, whichever covers no more than a cheaper one is in no best antichain.
void PricedColumn::drop_dominated() {
  kept_.clear();
  const auto dominates = [&](std::uint32_t a, std::uint32_t b) { return coverage_[a] >= coverage_[b] && price_[a] <= price_[b]; };
  for (Group& group : groups_) {
    group.kept_begin = static_cast<std::uint32_t>(kept_.size());
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      const auto first = kept_.end() - std::min<std::ptrdiff_t>(kMostCompared, std::ssize(kept_) - group.kept_begin);
      if (std::any_of(first, kept_.end(), [&](std::uint32_t k) { return dominates(k, i); })) continue;
      kept_.erase(std::remove_if(first, kept_.end(), [&](std::uint32_t k) { return dominates(i, k); }), kept_.end());
      kept_.push_back(i);
    }
    group.kept_end = static_cast<std::uint32_t>(kept_.size());
  }
}

// Backwards through the ranks, as AntichainFinder does it.
double PricedColumn::sum_of_roots(double bid) {
  looked_at_ += kept_.size();
  complete_.clear();
  double sum = 0.0;
  for (std::uint32_t g = static_cast<std::uint32_t>(groups_.size()); g-- > 0;) {
    Group& group = groups_[g];
    group.own = 0.0;
    for (std::uint32_t k = group.kept_begin; k < group.kept_end; ++k) {
      const double own = bid * coverage_[kept_[k]] - price_[kept_[k]];
      if (own <= group.own) continue;
      group.own = own;
      group.best = kept_[k];
    }
    group.parts = 0.0;
    for (; !complete_.empty() && groups_[complete_.back()].rank <= group.last_rank; complete_.pop_back())
      group.parts += groups_[complete_.back()].potential;
    group.potential = std::max(group.own, group.parts);
    complete_.push_back(g);
  }
  for (const std::uint32_t root : complete_) sum += groups_[root].potential;
  return sum;
}

void PricedColumn::find_subtrees() {
  complete_.clear();  // subtrees that are still open
  for (std::uint32_t g = 0; g <= groups_.size(); ++g) {
    for (; !complete_.empty() && (g == groups_.size() || groups_[g].rank > groups_[complete_.back()].last_rank); complete_.pop_back())
      groups_[complete_.back()].after = g;
    complete_.push_back(g);
  }
}

void PricedColumn::find_best(double bid, Line& line) {
  line.value = bid - sum_of_roots(bid);
  line.coverage = line.cost = 0.0;
  line.members.clear();
  for (std::uint32_t g = 0; g < groups_.size();) {
    const Group& group = groups_[g];
    if (!(group.own > 0.0) || group.own < group.parts) {
      ++g;
      continue;
    }
    line.coverage += coverage_[group.best];
    line.cost += price_[group.best];
    line.members.push_back(group.best);
    g = group.after;
  }
}

double PricedColumn::first_bid() const {
  double most = 0.0;
  for (std::uint32_t i = 0; i < size(); ++i) most = std::max(most, price_[i] / coverage_[i]);
  return std::isfinite(most) ? most : 0.0;
}

double PricedColumn::maximise(double start) {
  drop_dominated();
  low_ = {};
  double low = 0.0, high = start > 0.0 ? start : first_bid();
  bid_ = 0.0;
  double best = 0.0;
  const auto note = [&](double bid, const Line& line) {
    if (line.value > best) std::tie(best, bid_) = std::pair(line.value, bid);
  };
  find_best(high, high_);
  note(high, high_);
  for (int i = 0; i < kMostRaises && high_.coverage < kMet && high > 0.0; ++i) {
    low = high;
    std::swap(low_, high_);
    find_best(high *= kRaise, high_);
    note(high, high_);
  }
  for (int i = 0; i < kMostMeetings && high_.coverage > low_.coverage; ++i) {
    const double bid = (high_.cost - low_.cost) / (high_.coverage - low_.coverage);
    if (!(bid > low && bid < high)) break;
    const double meeting = bid * (1.0 - low_.coverage) + low_.cost;
    find_best(bid, middle_);
    note(bid, middle_);
    if (middle_.value >= meeting * (1.0 - 1e-9)) break;
    const bool enough = middle_.coverage >= kMet;
    (enough ? high : low) = bid;
    std::swap(enough ? high_ : low_, middle_);
  }
  return best;
}

std::vector<PricedColumn::Share> PricedColumn::optimum() const {
  std::vector<Share> shares;
  const double between = high_.coverage - low_.coverage;
  const double high = between > 0.0 ? std::clamp((1.0 - low_.coverage) / between, 0.0, 1.0) : 1.0;
  for (const std::uint32_t member : high_.members) shares.push_back({member, high});
  if (high >= 1.0) return shares;
  for (const std::uint32_t member : low_.members) {
    const auto both = std::ranges::find(shares, member, &Share::position);
    if (both != shares.end())
      both->share = 1.0;
    else
      shares.push_back({member, 1.0 - high});
  }
  return shares;
}

void PricedColumn::settle() {
  (void)sum_of_roots(bid_);
  for (std::uint32_t g = 0; g < groups_.size(); ++g)
    if (groups_[g].potential > groups_[g].parts) share_out(g);
}

// What the whole is worth beyond its parts goes to the topmost groups below it.
void PricedColumn::share_out(std::uint32_t group) {
  const std::uint32_t end = groups_[group].after;
  const auto weight = [&](const Group& part) {
    double most = 0.0;
    for (std::uint32_t i = part.begin; i < part.end; ++i) most = std::max(most, coverage_[i]);
    return most;
  };
  double sum = 0.0, parts = 0.0;
  for (std::uint32_t g = group + 1; g < end; g = groups_[g].after) {
    sum += weight(groups_[g]);
    parts += groups_[g].potential;
  }
  const double rest = groups_[group].potential - parts;
  if (!(rest > 0.0)) return;
  for (std::uint32_t g = group + 1; g < end; g = groups_[g].after) groups_[g].potential += rest * (weight(groups_[g]) / sum);
}

double PricedColumn::value(double bid) {
  drop_dominated();
  return bid - sum_of_roots(bid);
}

double PricedColumn::whole_value() {
  std::vector<std::pair<std::uint32_t, CostOfUnits>> complete;  // (rank, costs), the next by rank on top
  for (std::uint32_t g = static_cast<std::uint32_t>(groups_.size()); g-- > 0;) {
    const Group& group = groups_[g];
    CostOfUnits costs = nothing();
    for (bool first = true; !complete.empty() && complete.back().first <= group.last_rank; complete.pop_back(), first = false)
      costs = first ? complete.back().second : together(complete.back().second, costs);
    for (std::uint32_t i = group.begin; i < group.end; ++i) costs[units(coverage_[i])] = std::min(costs[units(coverage_[i])], price_[i]);
    make_monotone(costs);
    complete.emplace_back(group.rank, costs);
  }
  CostOfUnits costs = nothing();
  for (const auto& [rank, part] : complete) costs = together(part, costs);
  return costs[kUnits];
}

}  // namespace standin
