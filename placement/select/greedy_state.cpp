#include "placement/select/greedy_state.h"

#include <algorithm>

namespace standin {

GreedyState::GreedyState(const SelectionProblem& problem, const TreeOrder& order, const std::vector<bool>& ignored)
    : problem_(problem), order_(order), residual_(problem.deficit), met_(problem.cpv_count()), cpvs_(problem.cpv_count()) {
  const std::uint32_t stages = problem.stages;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    if (!ignored.empty() && ignored[p]) std::fill_n(residual_.begin() + static_cast<std::ptrdiff_t>(p) * stages, stages, 0.0);
    met_[p] = is_met(p);
    if (!met_[p]) ++unmet_;
  }
}

bool GreedyState::is_met(std::uint32_t cpv) const {
  const double* residual = residual_.data() + static_cast<std::size_t>(cpv) * problem_.stages;
  return std::all_of(residual, residual + problem_.stages, [](double r) { return r <= 0.0; });
}

bool GreedyState::ancestor_in_use(const Cpv& state, std::uint32_t node) const {
  const std::uint32_t rank = order_.first(node);
  const auto after =
      std::lower_bound(state.in_use.begin(), state.in_use.end(), rank, [](const InUse& used, std::uint32_t r) { return used.rank < r; });
  return after != state.in_use.begin() && order_.last(problem_.node[std::prev(after)->candidate]) >= rank;
}

GreedyState::Range GreedyState::accepted_inside(const Cpv& state, std::uint32_t node) const {
  const auto begin = std::lower_bound(state.net_rank.begin(), state.net_rank.end(), order_.first(node));
  const auto end = std::upper_bound(begin, state.net_rank.end(), order_.last(node));
  return {static_cast<std::size_t>(begin - state.net_rank.begin()), static_cast<std::size_t>(end - state.net_rank.begin())};
}

double GreedyState::net(const Cpv& state, Range inside, const Serving& serving, std::uint32_t stage) const {
  double represented = 0.0;
  for (std::size_t i = inside.begin; i < inside.end; ++i) represented += state.net[i * problem_.stages + stage];
  return problem_.gain(serving.candidate, serving.entry, stage) - represented;
}

double GreedyState::term(const Serving& serving) const {
  const std::uint32_t p = problem_.cpv[serving.entry];
  if (met_[p]) return 0.0;
  const Cpv& state = cpvs_[p];
  const std::uint32_t node = problem_.node[serving.candidate];
  if (ancestor_in_use(state, node)) return 0.0;
  const Range inside = accepted_inside(state, node);
  double sum = 0.0;
  for (std::uint32_t k = 0; k < problem_.stages; ++k) {
    const double net_ms = net(state, inside, serving, k);
    if (net_ms < 0.0) return 0.0;
    sum += std::min(net_ms, std::max(residual_[static_cast<std::size_t>(p) * problem_.stages + k], 0.0));
  }
  return sum;
}

double GreedyState::score(std::uint32_t candidate) const {
  double sum = 0.0;
  problem_.for_each_served(candidate, [&](std::uint32_t entry) { sum += term({candidate, entry}); });
  return sum / problem_.bytes[candidate];
}

void GreedyState::take(std::uint32_t candidate) {
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    if (term({candidate, entry}) > 0.0) use({candidate, entry});
  });
}

void GreedyState::use(const Serving& serving) {
  const std::uint32_t p = problem_.cpv[serving.entry];
  const std::uint32_t node = problem_.node[serving.candidate];
  Cpv& state = cpvs_[p];

  const Range inside = accepted_inside(state, node);
  std::vector<double> nets(problem_.stages);
  for (std::uint32_t k = 0; k < problem_.stages; ++k) nets[k] = net(state, inside, serving, k);
  for (std::uint32_t k = 0; k < problem_.stages; ++k) residual_[static_cast<std::size_t>(p) * problem_.stages + k] -= nets[k];
  state.net_rank.insert(state.net_rank.begin() + static_cast<std::ptrdiff_t>(inside.begin), order_.first(node));
  state.net.insert(state.net.begin() + static_cast<std::ptrdiff_t>(inside.begin * problem_.stages), nets.begin(), nets.end());

  const auto below = [&](const InUse& used) { return used.rank >= order_.first(node) && used.rank <= order_.last(node); };
  std::erase_if(state.in_use, below);
  const InUse added{order_.first(node), serving.candidate};
  state.in_use.insert(
      std::lower_bound(state.in_use.begin(), state.in_use.end(), added, [](const InUse& a, const InUse& b) { return a.rank < b.rank; }),
      added);
  if (!met_[p] && is_met(p)) {
    met_[p] = true;
    --unmet_;
  }
}

void GreedyState::represent(std::span<const Serving> antichain) {
  for (const Serving& serving : antichain) use(serving);
}

}  // namespace standin
