#include "placement/select/tight_rows.h"

#include <algorithm>
#include <tuple>

namespace standin {

void TightRows::see(std::uint32_t cpv, const std::vector<Serving>& antichain) {
  for (std::uint32_t stage = 0; stage < problem_.stages; ++stage) {
    const std::uint32_t constraint = cpv * problem_.stages + stage;
    if (!(problem_.deficit[constraint] > 0.0)) continue;
    double gained = 0.0;
    for (const Serving& serving : antichain) gained += problem_.gain(serving.candidate, serving.entry, stage);
    for (const Serving& serving : antichain) uses_[serving.candidate].push_back({gained / problem_.deficit[constraint], constraint});
  }
}

void TightRows::sort() {
  for (auto& uses : uses_)
    std::ranges::sort(uses, {}, [](const Use& use) { return std::tuple(use.coverage, use.constraint); });
}

std::vector<std::uint32_t> TightRows::tightest(std::size_t count) const {
  std::vector<std::uint32_t> rows;
  for (const auto& uses : uses_)
    for (std::size_t i = 0; i < std::min(count, uses.size()); ++i) rows.push_back(uses[i].constraint);
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

std::size_t TightRows::most() const {
  std::size_t most = 0;
  for (const auto& uses : uses_) most = std::max(most, uses.size());
  return most;
}

}  // namespace standin
