#include "placement/select/lagrangian_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "render/base/parallel.h"

namespace standin {
namespace {

// Below this the price D -> lambda / D could overflow; dropping a constraint only lowers the bound.
constexpr double kLeastDeficit = 1e-200;

constexpr int kPatience = 10;  // steps

constexpr std::size_t kChunk = 4096;  // candidates a task

// All steps together pass over so many gains at most, about a minute: with a thousand million of them the bound would take longer than
// everything it judges. The first steps gain most of it.
constexpr std::uint64_t kMostGains = 10'000'000'000;
constexpr std::uint64_t kLeastSteps = 10;

std::uint64_t gains_of(const SelectionProblem& problem, std::uint32_t candidate) {
  std::uint64_t gains = 0;
  for (const BlockRun& run : problem.runs_of(candidate)) gains += problem.block_offset[run.end] - problem.block_offset[run.begin];
  return gains * problem.stages;
}

int affordable_steps(const SelectionProblem& problem, int asked) {
  std::uint64_t gains = 1;
  for (std::uint32_t c = 0; c < problem.candidate_count(); ++c) gains += gains_of(problem, c);
  return static_cast<int>(std::min(static_cast<std::uint64_t>(std::max(asked, 0)), std::max(kLeastSteps, kMostGains / gains)));
}

/// Constraint q = (CPV, stage) is kept in units of its own deficit: coverage a / D in [0, 1] of a demand of 1, at a price lambda D in
/// bytes. Deficits of 1e-12 and 1e12 then weigh the same.
class Dual {
 public:
  Dual(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored, int threads)
      : problem_(problem),
        columns_(columns),
        threads_(threads),
        constraints_(problem.deficit.size()),
        price_(problem.deficit.size(), 0.0),
        paid_(problem.candidate_count()) {
    for (std::size_t q = 0; q < constraints_.size(); ++q)
      if (problem.deficit[q] > kLeastDeficit && (ignored.empty() || !ignored[q / problem.stages]))
        constraints_[q].deficit = problem.deficit[q];
    // Of the longest chain of additions behind the value; its terms are rounded a few times more.
    const double chain = static_cast<double>(longest_row() + problem.bytes.size() + problem.deficit.size() + 8);
    relative_error_ = std::max(1e-12, chain * 0.5 * std::numeric_limits<double>::epsilon());
  }

  /// Raises the price of one constraint after the other, rarest first, until some candidate is paid in full.
  void ascend(const WorkBudget& budget) {
    std::vector<double> slack = problem_.bytes;
    for (const std::uint32_t p : cpvs_by_coverage()) {
      budget.check();
      columns_.read(p, column_);
      for (std::uint32_t k = 0; k < problem_.stages; ++k) raise(p, k, slack);
    }
  }

  /// Deflected subgradient from the present prices; returns the best value seen. Where the relaxation has a gap, steps aimed at a known
  /// solution overshoot for ever: after a while without gain they are halved and start again from the best prices.
  double improve(double upper_bound_bytes, int iterations, const WorkBudget& budget) {
    std::vector<double> shortage(price_.size());
    std::vector<double> direction(price_.size(), 0.0);
    Best best{evaluate(shortage, budget), price_, shortage};
    double step_scale = 1.0;
    int without_gain = 0;
    for (int i = 0; i < iterations; ++i) {
      budget.check();
      const double squared = deflect(direction, shortage);
      if (squared <= 0.0) break;  // optimal prices
      const double step = step_scale * std::max(upper_bound_bytes - best.value, 1e-3 * upper_bound_bytes) / squared;
      for (std::size_t q = 0; q < direction.size(); ++q) price_[q] = std::max(0.0, price_[q] + step * direction[q]);
      if (const double value = evaluate(shortage, budget); value > best.value) {
        best = {value, price_, shortage};
        without_gain = 0;
      } else if (++without_gain == kPatience) {
        price_ = best.price;
        shortage = best.shortage;
        std::fill(direction.begin(), direction.end(), 0.0);
        step_scale *= 0.5;
        without_gain = 0;
      }
    }
    return best.value;
  }

 private:
  struct Best {
    double value = 0.0;
    std::vector<double> price;
    std::vector<double> shortage;
  };
  struct Constraint {
    double deficit = 0.0;         // 0: dropped
    double bytes_per_gain = 0.0;  // price / deficit
  };

  [[nodiscard]] std::size_t constraint(std::uint32_t entry, std::uint32_t stage) const {
    return static_cast<std::size_t>(problem_.cpv[entry]) * problem_.stages + stage;
  }
  /// a = min(max(gain, 0), deficit), 0 for a dropped constraint.
  [[nodiscard]] double useful_gain(const Serving& s, std::uint32_t stage) const {
    return std::max(0.0, std::min(problem_.gain(s.candidate, s.entry, stage), constraints_[constraint(s.entry, stage)].deficit));
  }

  void raise(std::uint32_t cpv, std::uint32_t stage, std::vector<double>& slack) {
    const std::size_t q = static_cast<std::size_t>(cpv) * problem_.stages + stage;
    const double deficit = constraints_[q].deficit;
    double most = std::numeric_limits<double>::infinity();
    for (const Serving& s : column_)
      if (const double useful = useful_gain(s, stage); useful > 0.0) most = std::min(most, slack[s.candidate] / (useful / deficit));
    if (!(most > 0.0) || std::isinf(most)) return;
    price_[q] = most;
    for (const Serving& s : column_)
      if (const double useful = useful_gain(s, stage); useful > 0.0) slack[s.candidate] -= most * (useful / deficit);
  }

  /// L(price) less its rounding error; `shortage[q]` becomes 1 - coverage by the candidates that are worth their price (a subgradient).
  double evaluate(std::vector<double>& shortage, const WorkBudget& budget) {
    double value = 0.0;
    for (std::size_t q = 0; q < price_.size(); ++q) {
      const bool dropped = constraints_[q].deficit <= 0.0;
      shortage[q] = dropped ? 0.0 : 1.0;
      constraints_[q].bytes_per_gain = dropped ? 0.0 : price_[q] / constraints_[q].deficit;
      value += price_[q];
    }
    double magnitude = value;
    collect_payments(budget);
    for (std::uint32_t c = 0; c < problem_.candidate_count(); ++c) {
      magnitude += paid_[c];
      if (paid_[c] <= problem_.bytes[c]) continue;
      value += problem_.bytes[c] - paid_[c];
      magnitude += problem_.bytes[c];
      cover_with(c, shortage);
    }
    return value - relative_error_ * magnitude;
  }

  /// Turns `direction` towards the shortage and returns its squared length. A price of 0 cannot fall: no part of the step.
  double deflect(std::vector<double>& direction, const std::vector<double>& shortage) const {
    double squared = 0.0;
    for (std::size_t q = 0; q < direction.size(); ++q) {
      direction[q] = 0.7 * shortage[q] + 0.3 * direction[q];
      if (price_[q] == 0.0) direction[q] = std::max(direction[q], 0.0);
      squared += direction[q] * direction[q];
    }
    return squared;
  }

  void collect_payments(const WorkBudget& budget) {
    const std::size_t chunks = (paid_.size() + kChunk - 1) / kChunk;
    parallel_for(chunks, threads_, budget, [&](std::size_t chunk) {
      const std::size_t end = std::min(paid_.size(), (chunk + 1) * kChunk);
      for (std::size_t c = chunk * kChunk; c < end; ++c) paid_[c] = payment(static_cast<std::uint32_t>(c));
    });
  }

  // Nearly all of the bound's time: one line per gain of the problem.
  [[nodiscard]] double payment(std::uint32_t candidate) const {
    const std::size_t stages = problem_.stages;
    const double* costs = problem_.cost.data() + candidate * problem_.forms * stages;
    double sum = 0.0;
    for (const BlockRun& run : problem_.runs_of(candidate)) {
      const std::size_t end = problem_.block_offset[run.end];
      for (std::size_t e = problem_.block_offset[run.begin]; e < end; ++e) {
        const std::size_t p = problem_.cpv[e];
        const double* cost = costs + problem_.form[p] * stages;
        for (std::size_t k = 0; k < stages; ++k) {
          const Constraint& at = constraints_[p * stages + k];
          sum += at.bytes_per_gain * std::max(0.0, std::min(problem_.worth[e * stages + k] - cost[k], at.deficit));
        }
      }
    }
    return sum;
  }

  void cover_with(std::uint32_t candidate, std::vector<double>& shortage) const {
    problem_.for_each_served(candidate, [&](std::uint32_t entry) {
      for (std::uint32_t k = 0; k < problem_.stages; ++k)
        if (const double useful = useful_gain({candidate, entry}, k); useful > 0.0)
          shortage[constraint(entry, k)] -= useful / constraints_[constraint(entry, k)].deficit;
    });
  }

  [[nodiscard]] std::vector<std::uint32_t> cpvs_by_coverage() const {
    std::vector<std::uint32_t> cpvs(problem_.cpv_count());
    std::vector<std::uint64_t> coverage(problem_.cpv_count());
    std::iota(cpvs.begin(), cpvs.end(), 0U);
    for (const std::uint32_t p : cpvs) coverage[p] = columns_.coverage(p);
    std::stable_sort(cpvs.begin(), cpvs.end(), [&](std::uint32_t a, std::uint32_t b) { return coverage[a] < coverage[b]; });
    return cpvs;
  }

  [[nodiscard]] std::uint64_t longest_row() const {
    std::uint64_t longest = 0;
    for (std::uint32_t c = 0; c < problem_.candidate_count(); ++c) longest = std::max(longest, gains_of(problem_, c));
    return longest;
  }

  const SelectionProblem& problem_;
  const Columns& columns_;
  int threads_;
  std::vector<Constraint> constraints_;
  std::vector<double> price_;    // bytes, >= 0
  std::vector<double> paid_;     // per candidate, at these prices
  std::vector<Serving> column_;  // of the CPV at hand
  double relative_error_ = 0.0;
};

}  // namespace

double lagrangian_bound(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored, double upper_bound_bytes,
                        int iterations, int threads, const WorkBudget& budget) {
  Dual dual(problem, columns, ignored, threads);
  dual.ascend(budget);
  return std::max(0.0, dual.improve(upper_bound_bytes, affordable_steps(problem, iterations), budget));
}

}  // namespace standin
