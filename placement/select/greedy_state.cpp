#include "placement/select/greedy_state.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace standin {

GreedyState::GreedyState(const SelectionProblem& problem, const Columns& columns, const std::vector<bool>& ignored,
                         std::vector<double> price)
    : problem_(problem),
      columns_(columns),
      price_(price.empty() ? problem.bytes : std::move(price)),
      residual_(problem.deficit),
      represented_(problem.worth.size(), 0.0) {
  const std::uint32_t stages = problem.stages;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    if (!ignored.empty() && ignored[p]) std::fill_n(residual_.begin() + static_cast<std::ptrdiff_t>(p) * stages, stages, 0.0);
    if (!is_met(p)) ++unmet_;
  }
}

bool GreedyState::is_met(std::uint32_t cpv) const {
  const double* residual = residual_.data() + static_cast<std::size_t>(cpv) * problem_.stages;
  return std::all_of(residual, residual + problem_.stages, [](double r) { return r <= 0.0; });
}

// The innermost loop of the selection: with one stage, the common case, it is two subtractions and two comparisons.
double GreedyState::score(std::uint32_t candidate) const {
  double sum = 0.0;
  if (problem_.stages == 1) {
    const double* costs = problem_.cost.data() + static_cast<std::size_t>(candidate) * problem_.forms;
    problem_.for_each_listed(candidate, [&](std::uint32_t entry) {
      const std::uint32_t p = problem_.cpv[entry];
      const double net_ms = problem_.worth[entry] - costs[problem_.form[p]] - represented_[entry];
      sum += std::max(std::min(net_ms, residual_[p]), 0.0);
    });
  } else {
    problem_.for_each_served(candidate, [&](std::uint32_t entry) { sum += term(candidate, entry); });
  }
  return sum / price_[candidate];
}

double GreedyState::term(std::uint32_t candidate, std::uint32_t entry) const {
  const double* residual = residual_.data() + static_cast<std::size_t>(problem_.cpv[entry]) * problem_.stages;
  double sum = 0.0;
  for (std::uint32_t k = 0; k < problem_.stages; ++k) {
    const double net_ms = net(candidate, entry, k);
    if (net_ms < 0.0) return 0.0;
    sum += std::min(net_ms, std::max(residual[k], 0.0));
  }
  return sum;
}

void GreedyState::take(std::uint32_t candidate) {
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    if (term(candidate, entry) > 0.0) use({candidate, entry});
  });
}

void GreedyState::use(const Serving& serving) {
  const std::uint32_t p = problem_.cpv[serving.entry];
  const std::uint32_t stages = problem_.stages;
  const bool was_met = is_met(p);
  std::vector<double> nets(stages);
  for (std::uint32_t k = 0; k < stages; ++k) nets[k] = net(serving.candidate, serving.entry, k);
  for (std::uint32_t k = 0; k < stages; ++k) residual_[static_cast<std::size_t>(p) * stages + k] -= nets[k];
  const auto represented = [&](std::uint32_t entry) { return represented_.begin() + static_cast<std::ptrdiff_t>(entry) * stages; };
  const std::uint32_t node = problem_.node[serving.candidate];
  columns_.for_each_around(p, node, [&](std::uint32_t entry) {
    for (std::uint32_t k = 0; k < stages; ++k) represented(entry)[k] += nets[k];
  });
  columns_.for_each_below(p, node,
                          [&](std::uint32_t entry) { std::fill_n(represented(entry), stages, std::numeric_limits<double>::infinity()); });
  if (was_met != is_met(p)) was_met ? ++unmet_ : --unmet_;
}

void GreedyState::represent(std::span<const Serving> antichain) {
  for (const Serving& serving : antichain) use(serving);
}

}  // namespace standin
