// The quadtree search over view directions for one cell (thesis 5.5.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/view_space/region_bound.h"

namespace standin {

/// A leaf region over budget: its bound, with the range of its terms in DirectionSearchResult::terms.
struct HotRegion {
  DirectionInterval interval;
  bool pixels_capped = false;  // as in RegionBound
  double constant_ms = 0.0;
  double predicted_ms = 0.0;
  std::size_t first_term = 0;
  std::size_t term_count = 0;
};

struct DirectionSearchResult {
  std::vector<HotRegion> hot;  // sorted by interval
  std::vector<RegionTerm> terms;
  double worst_predicted_ms = 0.0;  // over all leaf regions of the cell
  DirectionInterval worst_interval;

  [[nodiscard]] std::span<const RegionTerm> terms_of(const HotRegion& region) const {
    return std::span(terms).subspan(region.first_term, region.term_count);
  }
  void add(HotRegion region, std::span<const RegionTerm> its_terms);
};

/// All leaf intervals whose bound exceeds the budget, and the worst one in any case (by view, where none does: at most how bad it is).
/// `looser`: what a search of the same cell at a higher budget found, or none; its regions are taken over.
[[nodiscard]] DirectionSearchResult search_directions(const RegionEstimator& estimator, CellCosts& cell, double predicted_budget_ms,
                                                      const DirectionSearchResult* looser = nullptr);
/// What a search at a higher budget would return.
[[nodiscard]] DirectionSearchResult at_looser_budget(const DirectionSearchResult& found, double predicted_budget_ms);

}  // namespace standin
