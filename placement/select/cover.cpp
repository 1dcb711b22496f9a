#include "placement/select/cover.h"

#include <algorithm>
#include <utility>

namespace standin {

Cover::Cover(const SelectionProblem& problem, const TreeOrder& order)
    : problem_(problem),
      order_(order),
      finder_(problem, order),
      in_set_(problem.candidate_count(), false),
      serving_(problem.cpv_count()),
      antichain_(problem.cpv_count()) {}

std::vector<std::uint32_t> Cover::members() const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t c = 0; c < in_set_.size(); ++c)
    if (in_set_[c]) result.push_back(c);
  return result;
}

bool Cover::before(const Serving& a, const Serving& b) const {
  const std::uint32_t rank_a = order_.first(problem_.node[a.candidate]);
  const std::uint32_t rank_b = order_.first(problem_.node[b.candidate]);
  return rank_a != rank_b ? rank_a < rank_b : a.candidate < b.candidate;
}

bool Cover::uses(std::uint32_t cpv, std::uint32_t candidate) const {
  return std::ranges::binary_search(antichain_[cpv], candidate, {}, &Serving::candidate);
}

void Cover::add(std::uint32_t candidate) {
  if (in_set_[candidate]) return;
  in_set_[candidate] = true;
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    auto& column = serving_[problem_.cpv[entry]];
    const Serving added{candidate, entry};
    column.insert(std::lower_bound(column.begin(), column.end(), added, [&](const auto& a, const auto& b) { return before(a, b); }), added);
  });
}

std::optional<std::vector<Assignment>> Cover::replacements(std::uint32_t candidate) {
  std::vector<Assignment> result;
  bool possible = true;
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    const std::uint32_t p = problem_.cpv[entry];
    if (!possible || !uses(p, candidate)) return;
    Antichain other = finder_.best(serving_[p], p, candidate);
    possible = other.meets();
    result.push_back({p, std::move(other.members)});
  });
  if (!possible) return std::nullopt;
  return result;
}

std::vector<Assignment> Cover::best_without(std::uint32_t candidate) {
  std::vector<Assignment> result;
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    const std::uint32_t p = problem_.cpv[entry];
    if (uses(p, candidate)) result.push_back({p, finder_.best(serving_[p], p, candidate).members});
  });
  return result;
}

std::vector<Assignment> Cover::remove(std::uint32_t candidate, std::vector<Assignment> replacements) {
  in_set_[candidate] = false;
  problem_.for_each_served(candidate, [&](std::uint32_t entry) {
    std::erase_if(serving_[problem_.cpv[entry]], [&](const Serving& s) { return s.candidate == candidate; });
  });
  for (auto& [cpv, antichain] : replacements) std::swap(antichain_[cpv], antichain);
  return replacements;
}

void Cover::put_back(std::uint32_t candidate, std::vector<Assignment> previous) {
  add(candidate);
  for (auto& [cpv, antichain] : previous) antichain_[cpv] = std::move(antichain);
}

}  // namespace standin
