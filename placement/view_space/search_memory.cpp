#include "placement/view_space/search_memory.h"

namespace standin {

std::shared_ptr<const RememberedSearch> SearchMemory::recall(const CellKey& cell) const {
  const std::scoped_lock lock(mutex_);
  const auto found = cells_.find(cell);
  return found != cells_.end() ? found->second : nullptr;
}

void SearchMemory::keep(const CellKey& cell, double predicted_budget_ms, const DirectionSearchResult& found) {
  auto fresh = std::make_shared<const RememberedSearch>(predicted_budget_ms, found);
  const std::scoped_lock lock(mutex_);
  cells_[cell] = std::move(fresh);
}

}  // namespace standin
