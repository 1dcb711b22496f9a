#include "placement/select/lagrangian_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace standin {
namespace {

// Below this the price D -> lambda / D could overflow; dropping a constraint only lowers the bound.
constexpr double kLeastDeficit = 1e-200;

/// Constraints are kept in units of their own deficit: coverage a / D in [0, 1] of a demand of 1, price lambda D in bytes. Deficits of
/// 1e-12 and 1e12 then weigh the same.
class Dual {
 public:
  Dual(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored)
      : problem_(problem), columns_(columns), active_(problem.deficit.size()), price_(problem.deficit.size(), 0.0) {
    for (std::size_t q = 0; q < active_.size(); ++q)
      active_[q] = problem.deficit[q] > kLeastDeficit && (ignored.empty() || !ignored[q / problem.stages]);
    // Relative error of the longest chain of additions behind the value (each term rounded once more by its product).
    const double chain = static_cast<double>(longest_row() + problem.bytes.size() + problem.deficit.size() + 8);
    relative_error_ = std::max(1e-12, chain * 0.5 * std::numeric_limits<double>::epsilon());
  }

  /// Raises the price of one constraint after the other, rarest first, until some candidate is paid in full.
  void ascend(const WorkBudget& budget) {
    std::vector<double> slack = problem_.bytes;
    for (const std::uint32_t p : cpvs_by_coverage()) {
      budget.check();
      for (std::uint32_t k = 0; k < problem_.stages; ++k) raise(p, k, slack);
    }
  }

  /// L(price) less its rounding error; `shortage[q]` becomes 1 - coverage by the candidates that are worth their price (a subgradient).
  double evaluate(std::vector<double>& shortage) {
    double value = 0.0;
    double magnitude = 0.0;
    for (std::size_t q = 0; q < price_.size(); ++q) {
      shortage[q] = active_[q] ? 1.0 : 0.0;
      value += price_[q];
    }
    magnitude += value;
    for (std::uint32_t c = 0; c < problem_.candidate_count(); ++c) {
      const double paid = payment(c);
      magnitude += paid;
      if (paid <= problem_.bytes[c]) continue;
      value += problem_.bytes[c] - paid;
      magnitude += problem_.bytes[c];
      cover_with(c, shortage);
    }
    return value - relative_error_ * magnitude;
  }

  /// Deflected subgradient from the present prices; returns the best value seen.
  double improve(double upper_bound_bytes, int iterations, const WorkBudget& budget) {
    std::vector<double> shortage(price_.size());
    std::vector<double> direction(price_.size(), 0.0);
    double best = evaluate(shortage);
    double step_scale = 1.0;
    for (int i = 0; i < iterations; ++i) {
      budget.check();
      double squared = 0.0;
      for (std::size_t q = 0; q < direction.size(); ++q) {
        direction[q] = 0.7 * shortage[q] + 0.3 * direction[q];
        squared += direction[q] * direction[q];
      }
      if (squared <= 0.0) break;  // optimal prices
      const double step = step_scale * std::max(upper_bound_bytes - best, 1e-3 * upper_bound_bytes) / squared;
      for (std::size_t q = 0; q < direction.size(); ++q) price_[q] = std::max(0.0, price_[q] + step * direction[q]);
      step_scale *= 0.99;
      best = std::max(best, evaluate(shortage));
    }
    return best;
  }

 private:
  [[nodiscard]] double coverage(std::uint64_t entry, std::uint32_t stage) const {
    const std::size_t q = constraint(entry, stage);
    const double gain = problem_.gain[entry * problem_.stages + stage];
    if (!active_[q] || gain <= 0.0) return 0.0;
    return gain >= problem_.deficit[q] ? 1.0 : gain / problem_.deficit[q];
  }
  [[nodiscard]] std::size_t constraint(std::uint64_t entry, std::uint32_t stage) const {
    return static_cast<std::size_t>(problem_.cpv[entry]) * problem_.stages + stage;
  }

  [[nodiscard]] double payment(std::uint32_t candidate) const {
    double sum = 0.0;
    for (std::uint64_t e = problem_.offset[candidate]; e < problem_.offset[candidate + 1]; ++e)
      for (std::uint32_t k = 0; k < problem_.stages; ++k)
        if (const double price = price_[constraint(e, k)]; price > 0.0) sum += price * coverage(e, k);
    return sum;
  }

  void cover_with(std::uint32_t candidate, std::vector<double>& shortage) const {
    for (std::uint64_t e = problem_.offset[candidate]; e < problem_.offset[candidate + 1]; ++e)
      for (std::uint32_t k = 0; k < problem_.stages; ++k) shortage[constraint(e, k)] -= coverage(e, k);
  }

  void raise(std::uint32_t cpv, std::uint32_t stage, std::vector<double>& slack) {
    const auto column = columns_.of(cpv);
    double most = std::numeric_limits<double>::infinity();
    for (const Serving& s : column)
      if (const double share = coverage(s.entry, stage); share > 0.0) most = std::min(most, slack[s.candidate] / share);
    if (!(most > 0.0) || std::isinf(most)) return;
    price_[static_cast<std::size_t>(cpv) * problem_.stages + stage] = most;
    for (const Serving& s : column) slack[s.candidate] -= most * coverage(s.entry, stage);
  }

  [[nodiscard]] std::vector<std::uint32_t> cpvs_by_coverage() const {
    std::vector<std::uint32_t> cpvs(problem_.cpv_count());
    std::iota(cpvs.begin(), cpvs.end(), 0U);
    std::stable_sort(cpvs.begin(), cpvs.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return columns_.of(a).size() < columns_.of(b).size(); });
    return cpvs;
  }

  [[nodiscard]] std::uint64_t longest_row() const {
    std::uint64_t longest = 0;
    for (std::size_t c = 0; c + 1 < problem_.offset.size(); ++c) longest = std::max(longest, problem_.offset[c + 1] - problem_.offset[c]);
    return longest * problem_.stages;
  }

  const SelectionProblem& problem_;
  const Columns& columns_;
  std::vector<bool> active_;
  std::vector<double> price_;
  double relative_error_ = 0.0;
};

}  // namespace

double lagrangian_bound(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored, double upper_bound_bytes,
                        int iterations, const WorkBudget& budget) {
  Dual dual(problem, columns, ignored);
  dual.ascend(budget);
  return std::max(0.0, dual.improve(upper_bound_bytes, iterations, budget));
}

}  // namespace standin
