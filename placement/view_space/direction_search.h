// The quadtree search over view directions for one cell (thesis 5.5.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/view_space/region_bound.h"

namespace standin {

/// A leaf region over budget, with the range of its objects in DirectionSearchResult::seen.
struct HotRegion {
  DirectionInterval interval;
  double predicted_ms = 0.0;  // its bound
  std::size_t first_seen = 0;
  std::size_t seen_count = 0;
};

struct DirectionSearchResult {
  std::vector<HotRegion> hot;       // sorted by interval
  std::vector<std::uint32_t> seen;  // indices into CellCosts::objects, ascending per region: a quarter of the memory of terms
  double worst_predicted_ms = 0.0;  // over all leaf regions of the cell
  DirectionInterval worst_interval;

  [[nodiscard]] std::span<const std::uint32_t> seen_in(const HotRegion& region) const {
    return std::span(seen).subspan(region.first_seen, region.seen_count);
  }
};

/// All leaf intervals whose bound exceeds the budget, and the worst one in any case.
[[nodiscard]] DirectionSearchResult search_directions(const RegionEstimator& estimator, CellCosts& cell, double predicted_budget_ms);

}  // namespace standin
