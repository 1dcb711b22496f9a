// The exact optimum of small selection problems, by trying every set (<= 16 candidates): the oracle for the selector.
//
// It shares no code with placement/select. A set meets a CPV when one of its antichains does, gains added in extended precision.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "placement/select/selection_problem.h"

namespace standin::test {

class BruteForce {
 public:
  explicit BruteForce(const SelectionProblem& problem) : problem_(problem) {}

  struct Optimum {
    double bytes = std::numeric_limits<double>::infinity();
    std::vector<std::uint32_t> set;
  };

  /// Least bytes of a set that meets every CPV not in `except`; nothing if there is none.
  [[nodiscard]] std::optional<Optimum> optimum(const std::set<std::uint32_t>& except = {}) const {
    Optimum best;
    for (std::uint32_t mask = 0; mask < (1U << problem_.candidate_count()); ++mask) {
      const auto set = members(mask);
      double bytes = 0.0;
      for (const auto c : set) bytes += problem_.bytes[c];
      if (bytes < best.bytes && meets_all(set, except)) best = {bytes, set};
    }
    if (best.bytes == std::numeric_limits<double>::infinity()) return std::nullopt;
    return best;
  }

  [[nodiscard]] bool meets_all(const std::vector<std::uint32_t>& set, const std::set<std::uint32_t>& except) const {
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p)
      if (except.count(p) == 0 && least_violation(set, p) > 0.0) return false;
    return true;
  }

  /// Least sum over stages of what is missing at a CPV, over the antichains of `set`.
  [[nodiscard]] double least_violation(const std::vector<std::uint32_t>& set, std::uint32_t cpv) const {
    std::vector<std::uint32_t> antichain;
    return least_from(set, 0, antichain, cpv);
  }

  [[nodiscard]] double violation(const std::vector<std::uint32_t>& antichain, std::uint32_t cpv) const {
    long double missing = 0.0L;
    for (std::uint32_t k = 0; k < problem_.stages; ++k) {
      long double sum = 0.0L;
      for (const auto c : antichain) sum += gain(c, cpv, k);
      const long double deficit = problem_.deficit[std::size_t{cpv} * problem_.stages + k];
      if (sum < deficit) missing += deficit - sum;
    }
    return static_cast<double>(missing);
  }

  [[nodiscard]] bool is_antichain(const std::vector<std::uint32_t>& set) const {
    for (std::size_t a = 0; a < set.size(); ++a)
      for (std::size_t b = 0; b < set.size(); ++b)
        if (a != b && inside(problem_.node[set[a]], problem_.node[set[b]])) return false;
    return true;
  }

  [[nodiscard]] bool serves(std::uint32_t candidate, std::uint32_t cpv) const {
    for (std::uint32_t k = 0; k < problem_.stages; ++k)
      if (gain(candidate, cpv, k) > 0.0) return true;
    return false;
  }

 private:
  [[nodiscard]] std::vector<std::uint32_t> members(std::uint32_t mask) const {
    std::vector<std::uint32_t> set;
    for (std::uint32_t c = 0; c < problem_.candidate_count(); ++c)
      if ((mask >> c & 1U) != 0) set.push_back(c);
    return set;
  }

  [[nodiscard]] double gain(std::uint32_t candidate, std::uint32_t cpv, std::uint32_t stage) const {
    const auto& p = problem_;
    for (auto r = p.run_offset[candidate]; r < p.run_offset[candidate + 1]; ++r)
      for (auto e = p.block_offset[p.runs[r].begin]; e < p.block_offset[p.runs[r].end]; ++e)
        if (p.cpv[e] == cpv)
          return p.worth[std::size_t{e} * p.stages + stage] - p.cost[(std::size_t{candidate} * p.forms + p.form[cpv]) * p.stages + stage];
    return 0.0;
  }

  /// Whether node a is b or lies below it.
  [[nodiscard]] bool inside(std::uint32_t a, std::uint32_t b) const {
    auto node = static_cast<std::int32_t>(a);
    while (node >= 0 && node != static_cast<std::int32_t>(b)) node = problem_.parent[static_cast<std::size_t>(node)];
    return node >= 0;
  }

  [[nodiscard]] double least_from(const std::vector<std::uint32_t>& set, std::size_t i, std::vector<std::uint32_t>& antichain,
                                  std::uint32_t cpv) const {
    if (i == set.size()) return violation(antichain, cpv);
    double least = least_from(set, i + 1, antichain, cpv);
    antichain.push_back(set[i]);
    if (serves(set[i], cpv) && is_antichain(antichain)) least = std::min(least, least_from(set, i + 1, antichain, cpv));
    antichain.pop_back();
    return least;
  }

  const SelectionProblem& problem_;
};

}  // namespace standin::test
