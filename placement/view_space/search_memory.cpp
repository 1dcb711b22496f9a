#include "placement/view_space/search_memory.h"

namespace standin {
namespace {

DirectionSearchResult at_looser_budget(const DirectionSearchResult& tight, double predicted_budget_ms) {
  DirectionSearchResult loose;
  loose.worst_predicted_ms = tight.worst_predicted_ms;
  loose.worst_interval = tight.worst_interval;
  for (const HotRegion& region : tight.hot) {
    if (region.predicted_ms <= predicted_budget_ms) continue;
    const auto seen = tight.seen_in(region);
    loose.hot.push_back({region.interval, region.predicted_ms, loose.seen.size(), seen.size()});
    loose.seen.insert(loose.seen.end(), seen.begin(), seen.end());
  }
  return loose;
}

}  // namespace

std::optional<DirectionSearchResult> SearchMemory::recall(const CellKey& cell, double predicted_budget_ms) const {
  std::shared_ptr<const Remembered> known;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = cells_.find(cell); found != cells_.end()) known = found->second;
  }
  if (known == nullptr || known->predicted_budget_ms > predicted_budget_ms) return std::nullopt;
  return at_looser_budget(known->found, predicted_budget_ms);
}

void SearchMemory::keep(const CellKey& cell, double predicted_budget_ms, const DirectionSearchResult& found) {
  auto fresh = std::make_shared<const Remembered>(predicted_budget_ms, found);
  const std::scoped_lock lock(mutex_);
  cells_[cell] = std::move(fresh);
}

}  // namespace standin
