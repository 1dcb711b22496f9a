// What some single views of a region cost: its demand in the `sampled` mode, which promises nothing.
//
// A region's bound (region_bound.h) adds up each object's dearest view, and holds for all. The dearest single view costs less, since no
// view has all objects at their dearest at once: what the certificate costs in memory is seen by placing for sampled views instead. The
// worst of these, with a margin for the views between them, is what must be brought within the budget; it is shared out among the objects
// as the slowest of the views have it on average, so that impostors help all of these and not one alone.
#pragma once

#include <cstdint>
#include <span>

#include "estimation/feature_table.h"
#include "estimation/time_model.h"
#include "placement/view_space/region_views.h"

namespace standin {

inline constexpr std::uint32_t kSampledViews = 32;
/// Of the worst sampled view, for those not sampled.
inline constexpr double kSampledMargin = 0.05;

/// Sets `costs` of `objects` (each at its level of detail; none given: its own parts): with `frame_ms` they add up to the predicted time of
/// the region's worst view, with the margin, and at most to `bound_ms`.
void cost_by_views(const FeatureTable& features, const TimeModel& model, RegionViews region, std::span<const std::uint32_t> objects,
                   std::span<const std::uint8_t> levels, double frame_ms, double bound_ms, std::span<Cost> costs);

}  // namespace standin
