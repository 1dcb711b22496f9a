// What the direction searches (thesis 5.5.2) of one scene found, so that a looser budget need not search again.
//
// The thesis subdivides once for one budget; who asks for several meets the same cells and bounds each time. A search at a tight budget
// holds all that a looser one finds: the looser budget's hot regions are those whose bound exceeds it, and the worst region does not depend
// on the budget. A cell asked for at a tighter budget than before is searched anew.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "placement/view_space/direction_search.h"
#include "placement/view_space/view_space.h"

namespace standin {

/// Belongs to one scene, view space, visibility, time model and camera. May be used from several threads.
class SearchMemory {
 public:
  /// What a search of `cell` at this budget would return (the order within `seen` aside), where one at no greater budget is known.
  [[nodiscard]] std::optional<DirectionSearchResult> recall(const CellKey& cell, double predicted_budget_ms) const;
  void keep(const CellKey& cell, double predicted_budget_ms, const DirectionSearchResult& found);

 private:
  struct Remembered {
    double predicted_budget_ms = 0.0;
    DirectionSearchResult found;
  };

  mutable std::mutex mutex_;
  std::map<CellKey, std::shared_ptr<const Remembered>> cells_;
};

}  // namespace standin
