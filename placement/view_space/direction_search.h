// The quadtree search over view directions for one cell (thesis 5.5.2).
#pragma once

#include <vector>

#include "placement/view_space/region_bound.h"

namespace standin {

/// A leaf region over budget.
struct HotRegion {
  DirectionInterval interval;
  RegionBound bound;
};

struct DirectionSearchResult {
  std::vector<HotRegion> hot;       // sorted by interval
  double worst_predicted_ms = 0.0;  // over all leaf regions of the cell
  DirectionInterval worst_interval;
};

/// All leaf intervals whose bound exceeds the budget, and the worst one in any case.
[[nodiscard]] DirectionSearchResult search_directions(const RegionEstimator& estimator, const CellCosts& cell, double predicted_budget_ms);

}  // namespace standin
