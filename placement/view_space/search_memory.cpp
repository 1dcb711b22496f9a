#include "placement/view_space/search_memory.h"

namespace standin {

std::shared_ptr<const RememberedSearch> SearchMemory::recall(const SearchRequest& request) {
  const std::scoped_lock lock(mutex_);
  const auto found = cells_.find(request.cell);
  return found != cells_.end() ? found->second : nullptr;
}

void SearchMemory::keep(const SearchRequest& request, const DirectionSearchResult& found) {
  auto fresh = std::make_shared<const RememberedSearch>(RememberedSearch{request.predicted_budget_ms, found});
  const std::scoped_lock lock(mutex_);
  cells_[request.cell] = std::move(fresh);
}

}  // namespace standin
