#include "placement/select/tight_constraints.h"

#include <algorithm>

namespace standin {

void TightConstraints::see(std::uint32_t cpv, const std::vector<Serving>& antichain) {
  for (std::uint32_t stage = 0; stage < problem_.stages; ++stage) {
    const std::uint32_t constraint = cpv * problem_.stages + stage;
    if (!(problem_.deficit[constraint] > 0.0)) continue;
    double gained = 0.0;
    for (const Serving& serving : antichain) gained += problem_.gain(serving.candidate, serving.entry, stage);
    for (const Serving& serving : antichain)
      if (problem_.gain(serving.candidate, serving.entry, stage) > 0.0)
        uses_[serving.candidate].push_back({gained / problem_.deficit[constraint], constraint});
  }
}

void TightConstraints::sort() {
  for (auto& uses : uses_) std::ranges::sort(uses);
}

std::vector<std::uint32_t> TightConstraints::tightest(std::size_t count) const {
  std::vector<Use> taken;
  for (const auto& uses : uses_)
    taken.insert(taken.end(), uses.begin(), uses.begin() + static_cast<std::ptrdiff_t>(std::min(count, uses.size())));
  std::ranges::sort(taken);
  std::vector<std::uint32_t> constraints;
  for (const Use& use : taken) constraints.push_back(use.constraint);
  constraints.erase(std::unique(constraints.begin(), constraints.end()), constraints.end());  // uses of one constraint are equally tight
  return constraints;
}

std::size_t TightConstraints::most() const {
  std::size_t most = 0;
  for (const auto& uses : uses_) most = std::max(most, uses.size());
  return most;
}

}  // namespace standin
