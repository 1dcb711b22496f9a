#include "placement/select/lagrangian_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace standin {
namespace {

// Below this, coverages could overflow; dropping a constraint only lowers the bound.
constexpr double kLeastDeficit = 1e-200;

constexpr int kPlainSweeps = 2;  // after the first, before the first step
constexpr double kFirstFactor = 1.0;
constexpr int kPatience = 6;  // steps without gain before they are shortened
constexpr double kShorter = 0.6;
constexpr double kWorthwhileGain = 1e-3;  // of the known solution's bytes, by kPatience steps together: with less the search ends
constexpr float kKept = 0.95F;            // of the use so far, each time a constraint is visited
constexpr float kLeastShare = 0.005F;

// All sweeps of one improve() pass over so many gains at most, some ten seconds. The first sweeps gain most of it.
constexpr std::uint64_t kMostGains = 100'000'000;
constexpr std::size_t kLeastTightest = 4;  // constraints of each member, before more of them may be found not to be worth it
// Constraints with so many gains are enough of them.
constexpr std::uint64_t kMostBoundGains = 2'000'000;

int affordable_sweeps(std::uint64_t gains, int asked) {
  return static_cast<int>(std::min(static_cast<std::uint64_t>(std::max(asked, 0)), kMostGains / std::max<std::uint64_t>(gains, 1)));
}

}  // namespace

BytesSplit::BytesSplit(const SelectionProblem& problem, const TreeOrder& order, const Columns& columns)
    : problem_(problem),
      columns_(columns),
      column_(problem, order),
      bid_(problem.deficit.size(), 0.0),
      potential_(problem.worth.size(), 0.0),
      free_(problem.bytes),
      demands_(problem.candidate_count(), 0),
      use_(problem.deficit.size()),
      mean_use_(problem.candidate_count(), 0.0),
      shrink_(problem.candidate_count(), 1.0),
      used_(problem.candidate_count(), 0.0F) {
  keep_as_best();
}

void BytesSplit::add(std::span<const std::uint32_t> constraints, std::uint64_t most_gains, const WorkBudget& budget) {
  const std::vector<std::uint32_t> before = active_;
  for (const std::uint32_t q : constraints) {
    if (gains_ >= most_gains) break;
    if (!(problem_.deficit[q] > kLeastDeficit) || std::ranges::binary_search(before, q)) continue;
    budget.check();
    load(q);
    gains_ += column_.size();
    for (std::uint32_t i = 0; i < column_.size(); ++i) ++demands_[column_.candidate(i)];
    active_.push_back(q);
  }
  std::ranges::sort(active_);
}

void BytesSplit::load(std::uint32_t q) {
  columns_.read(q / problem_.stages, servings_);
  column_.load(servings_, q / problem_.stages, q % problem_.stages);
  q_ = q;
  work_ += column_.size();
}

double BytesSplit::payment(const PricedColumn::Group& group, std::uint32_t position) const {
  const double potential = potential_[static_cast<std::size_t>(group.entry) * problem_.stages + q_ % problem_.stages];
  return std::max(0.0, bid_[q_] * column_.coverage(position) - potential);
}

template <class Visit>
void BytesSplit::for_each_payment(Visit&& visit) const {
  for (const PricedColumn::Group& group : column_.groups())
    for (std::uint32_t i = group.begin; i < group.end; ++i) visit(i, column_.candidate(i), payment(group, i));
}

double BytesSplit::shifted(std::uint32_t candidate, double payment) const {
  if (length_ == 0.0) return payment;
  return shrink_[candidate] * std::max(0.0, payment + length_ * (static_cast<double>(used_[candidate]) - mean_use_[candidate]));
}

double BytesSplit::visit(std::uint32_t q) {
  load(q);
  for (const Use& use : use_[q]) used_[use.candidate] = use.share;
  for_each_payment([&](std::uint32_t i, std::uint32_t candidate, double paid) {
    const double now = shifted(candidate, paid);
    column_.set_price(i, now + std::max(0.0, free_[candidate]) / remaining_[candidate]--);
    free_[candidate] += now;
  });
  for (const Use& use : use_[q]) used_[use.candidate] = 0.0F;

  const double value = column_.maximise(bid_[q]);
  keep_optimum(q);
  column_.settle();
  bid_[q] = column_.bid();
  for (const PricedColumn::Group& group : column_.groups())
    potential_[static_cast<std::size_t>(group.entry) * problem_.stages + q % problem_.stages] = group.potential;
  for_each_payment([&](std::uint32_t, std::uint32_t candidate, double paid) { free_[candidate] -= paid; });
  return value;
}

// Not the latest optimum alone: single ones jump from corner to corner, their mean comes near what all of them together would have.
void BytesSplit::keep_optimum(std::uint32_t q) {
  for (Use& use : use_[q]) used_[use.candidate] = use.share *= kKept;
  for (const PricedColumn::Share& share : column_.optimum()) {
    const std::uint32_t candidate = column_.candidate(share.position);
    if (used_[candidate] == 0.0F) use_[q].push_back({candidate, 0.0F});
    used_[candidate] += (1.0F - kKept) * static_cast<float>(share.share);
  }
  for (Use& use : use_[q]) use.share = std::exchange(used_[use.candidate], 0.0F);
  std::erase_if(use_[q], [](const Use& use) { return use.share < kLeastShare; });
}

double BytesSplit::sweep(const WorkBudget& budget) {
  remaining_ = demands_;
  value_ = 0.0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    if (i % 64 == 0) budget.check();
    value_ += visit(active_[forwards_ ? i : active_.size() - 1 - i]);
  }
  for (const double bytes : free_) value_ += std::min(bytes, 0.0);
  forwards_ = !forwards_;
  length_ = 0.0;
  if (value_ > best_value_) keep_as_best();
  return value_;
}

double BytesSplit::step(double factor, double aim_bytes, const WorkBudget& budget) {
  shift_payments(factor, aim_bytes, budget);
  return sweep(budget);
}

// Towards use_ less its mean over the constraints of each candidate, so that the payments of a candidate keep their sum.
void BytesSplit::shift_payments(double factor, double aim_bytes, const WorkBudget& budget) {
  std::fill(mean_use_.begin(), mean_use_.end(), 0.0);
  double squared = 0.0;
  for (const auto& uses : use_)
    for (const Use& use : uses) {
      squared += static_cast<double>(use.share) * use.share;
      mean_use_[use.candidate] += use.share;
    }
  for (std::size_t c = 0; c < mean_use_.size(); ++c) {
    if (demands_[c] == 0) continue;
    squared -= mean_use_[c] * mean_use_[c] / demands_[c];
    mean_use_[c] /= demands_[c];
  }
  if (!(squared > 1e-9)) return;  // everybody uses the same
  length_ = factor * std::max(aim_bytes - value_, 1e-3 * aim_bytes) / squared;

  std::fill(shrink_.begin(), shrink_.end(), 1.0);
  free_ = problem_.bytes;
  for (const std::uint32_t q : active_) {
    budget.check();
    load(q);
    for (const Use& use : use_[q]) used_[use.candidate] = use.share;
    for_each_payment([&](std::uint32_t, std::uint32_t candidate, double paid) { free_[candidate] -= shifted(candidate, paid); });
    for (const Use& use : use_[q]) used_[use.candidate] = 0.0F;
  }
  for (std::size_t c = 0; c < free_.size(); ++c) {
    if (free_[c] >= 0.0) continue;
    shrink_[c] = problem_.bytes[c] / (problem_.bytes[c] - free_[c]);
    free_[c] = 0.0;
  }
}

void BytesSplit::keep_as_best() {
  best_value_ = value_;
  best_bid_ = bid_;
  best_potential_ = potential_;
  best_free_ = free_;
}

void BytesSplit::return_to_best() {
  value_ = best_value_;
  bid_ = best_bid_;
  potential_ = best_potential_;
  free_ = best_free_;
}

double BytesSplit::certified(const WorkBudget& budget) {
  std::vector<double> claimed(problem_.candidate_count(), 0.0);
  double value = 0.0, magnitude = 0.0;
  for (const std::uint32_t q : active_) {
    budget.check();
    load(q);
    for_each_payment([&](std::uint32_t i, std::uint32_t candidate, double paid) {
      column_.set_price(i, paid);
      claimed[candidate] += paid;
    });
    const double least = column_.value(bid_[q]);
    const double whole = column_.whole_value();
    value += std::max({0.0, least, std::isfinite(whole) ? whole : 0.0});
    magnitude += 2.0 * bid_[q] + std::abs(least);
  }
  for (std::size_t c = 0; c < claimed.size(); ++c) {
    value -= std::max(0.0, claimed[c] - problem_.bytes[c]);
    magnitude += claimed[c];
  }
  // Of the longest chain of additions behind the value; its terms are rounded a few times more.
  const double chain = static_cast<double>(active_.size() + problem_.bytes.size() + problem_.parent.size() + 8);
  const double relative_error = std::max(1e-12, chain * 0.5 * std::numeric_limits<double>::epsilon());
  return std::max(0.0, value - relative_error * magnitude);
}

bool improve(BytesSplit& split, double aim_bytes, int iterations, const WorkBudget& budget, SelectionWork& work) {
  const int sweeps = affordable_sweeps(split.gains(), iterations);
  double factor = kFirstFactor;
  int without_gain = 0;
  bool finished = true;
  std::array<double, kPatience> recent{};  // best values, one for each of the latest steps
  recent.fill(-std::numeric_limits<double>::infinity());
  for (int i = 0; i <= sweeps && finished; ++i) {
    const double before = split.best_value();
    double& long_ago = recent[static_cast<std::size_t>(i) % kPatience];
    if (i > kPlainSweeps + kPatience && before - long_ago < kWorthwhileGain * aim_bytes) break;
    long_ago = before;
    const std::uint64_t work_before = split.work();
    if (i <= kPlainSweeps)
      split.sweep(budget);
    else
      split.step(factor, aim_bytes, budget);
    work.spend(split.work() - work_before);
    finished = i == sweeps || !work.exhausted();
    without_gain = split.best_value() > before ? 0 : without_gain + 1;
    if (without_gain < kPatience) continue;
    factor *= kShorter;
    without_gain = 0;
    split.return_to_best();
  }
  split.return_to_best();
  return finished;
}

bool improve_by(const TightConstraints& tight, BytesSplit& split, double known_bytes, int iterations, const WorkBudget& budget,
                SelectionWork& work) {
  for (std::size_t count = 1;; count *= 2) {
    const double before = split.best_value();
    if (count > 1 && work.exhausted()) return false;
    const std::uint64_t work_before = split.work();
    split.add(tight.tightest(count), kMostBoundGains, budget);
    work.spend(split.work() - work_before);
    if (!improve(split, known_bytes, iterations, budget, work)) return false;
    const bool gained = split.best_value() - before >= kWorthwhileGain * known_bytes;
    if (count >= tight.most() || split.gains() >= kMostBoundGains || (count >= kLeastTightest && !gained)) return true;
  }
}

}  // namespace standin
