#include "placement/select/greedy_state.h"

#include <algorithm>

namespace standin {

GreedyState::GreedyState(const SelectionProblem& problem, const TreeOrder& order, const std::vector<bool>& ignored)
    : problem_(problem),
      order_(order),
      residual_(problem.deficit),
      met_(problem.cpv_count()),
      touched_(problem.cpv_count()),
      cpvs_(problem.cpv_count()) {
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

// Impostors in use are disjoint, and the node of each starts with a net of its own: whatever comes last before `node` lies in the only one
// that can reach over it.
GreedyState::Range GreedyState::inside(const Cpv& state, std::uint32_t node) const {
  const std::uint32_t first = order_.first(node);
  const std::uint32_t last = order_.last(node);
  const auto begin = std::ranges::lower_bound(state.accepted, first, {}, &Accepted::rank);
  auto end = begin;
  while (end != state.accepted.end() && end->rank <= last) ++end;
  return {static_cast<std::size_t>(begin - state.accepted.begin()), static_cast<std::size_t>(end - state.accepted.begin()),
          begin != state.accepted.begin() && std::prev(begin)->used_last >= first};
}

double GreedyState::net(const Cpv& state, const Range& range, const Serving& serving, std::uint32_t stage) const {
  double represented = 0.0;
  for (std::size_t i = range.begin; i < range.end; ++i) represented += state.net[i * problem_.stages + stage];
  return problem_.gain(serving.candidate, serving.entry, stage) - represented;
}

double GreedyState::term(const Serving& serving) const {
  const std::uint32_t p = problem_.cpv[serving.entry];
  if (met_[p]) return 0.0;
  const Cpv& state = cpvs_[p];
  const Range range = touched_[p] ? inside(state, problem_.node[serving.candidate]) : Range{};
  if (range.ancestor_in_use) return 0.0;
  double sum = 0.0;
  for (std::uint32_t k = 0; k < problem_.stages; ++k) {
    const double net_ms = net(state, range, serving, k);
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
  touched_[p] = true;

  const Range range = inside(state, node);
  std::vector<double> nets(problem_.stages);
  for (std::uint32_t k = 0; k < problem_.stages; ++k) nets[k] = net(state, range, serving, k);
  for (std::uint32_t k = 0; k < problem_.stages; ++k) residual_[static_cast<std::size_t>(p) * problem_.stages + k] -= nets[k];
  for (std::size_t i = range.begin; i < range.end; ++i) state.accepted[i].used_last = order_.last(node);
  state.accepted.insert(state.accepted.begin() + static_cast<std::ptrdiff_t>(range.begin), {order_.first(node), order_.last(node)});
  state.net.insert(state.net.begin() + static_cast<std::ptrdiff_t>(range.begin * problem_.stages), nets.begin(), nets.end());
  if (!met_[p] && is_met(p)) {
    met_[p] = true;
    --unmet_;
  }
}

void GreedyState::represent(std::span<const Serving> antichain) {
  for (const Serving& serving : antichain) use(serving);
}

}  // namespace standin
