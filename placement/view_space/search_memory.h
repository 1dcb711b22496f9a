// What the direction searches (thesis 5.5.2) of one scene found, so that another budget need not search all again.
//
// The thesis subdivides once for one budget; who asks for several meets the same cells and bounds each time. A search at a tight budget
// holds all that a looser one finds: the looser budget's hot regions are those whose bound exceeds it, and the worst region does not depend
// on the budget. A cell asked for at a tighter budget than before is searched again, but for the regions already known.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "placement/view_space/direction_search.h"
#include "placement/view_space/view_space.h"

namespace standin {

struct RememberedSearch {
  double predicted_budget_ms = 0.0;
  DirectionSearchResult found;
};

/// Belongs to one scene, view space, visibility, time model and camera. May be used from several threads.
class SearchMemory {
 public:
  /// The last search of `cell`; nullptr: none.
  [[nodiscard]] std::shared_ptr<const RememberedSearch> recall(const CellKey& cell) const;
  void keep(const CellKey& cell, double predicted_budget_ms, const DirectionSearchResult& found);

 private:
  mutable std::mutex mutex_;
  std::map<CellKey, std::shared_ptr<const RememberedSearch>> cells_;
};

}  // namespace standin
