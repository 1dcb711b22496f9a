// What the direction searches (thesis 5.5.2) of one scene found, so that another budget need not search all again.
//
// The thesis subdivides once for one budget; who asks for several meets the same cells and bounds each time. A search at a tight budget
// holds all that a looser one finds: the looser budget's hot regions are those whose bound exceeds it, and the worst region does not depend
// on the budget. A cell asked for at a tighter budget than before is searched again, but for the regions already known. Who remembers for
// longer than one job derives from it (server/cache).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "placement/view_space/direction_search.h"
#include "placement/view_space/view_space.h"

namespace standin {

struct RememberedSearch {
  double predicted_budget_ms = 0.0;
  DirectionSearchResult found;
};

/// What is asked for: a cell, and what its search looks at beside the scene, the time model and the camera.
struct SearchRequest {
  CellKey cell;
  double predicted_budget_ms = 0.0;
  std::span<const Box> chain{};   // the cell's box and those of its ancestors up to the leaf level
  std::int32_t visible_set = -1;  // as Cell::visible_set
};

/// Belongs to one scene, view space, visibility, time model and camera. May be used from several threads.
class SearchMemory {
 public:
  SearchMemory() = default;
  virtual ~SearchMemory() = default;
  SearchMemory(const SearchMemory&) = delete;
  SearchMemory& operator=(const SearchMemory&) = delete;

  /// The last search of the cell, at whatever budget; nullptr: none.
  [[nodiscard]] virtual std::shared_ptr<const RememberedSearch> recall(const SearchRequest& request);
  virtual void keep(const SearchRequest& request, const DirectionSearchResult& found);

 private:
  std::mutex mutex_;
  std::map<CellKey, std::shared_ptr<const RememberedSearch>> cells_;
};

}  // namespace standin
