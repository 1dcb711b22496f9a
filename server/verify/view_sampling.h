// Which views verification looks at: half at random, half where a placement is most likely to break its promise.
//
// Random views lie inside the regions that were over budget (three of four) or anywhere in the view space. The others are corners of such
// regions' cells seen along corners of their direction interval, borders of intervals, the regions whose bound selection left closest to
// the budget, and straight runs through the view space as a camera would take them. Borders belong to whatever the look-up says: that is
// part of the test. The first n views are the same however many are asked for.
#pragma once

#include <cstdint>
#include <vector>

#include "placement/runtime/placement.h"
#include "placement/view_space/view_space.h"
#include "server/verify/verify.h"

namespace standin {

/// `count` views with their origins; all else is left empty. Without regions over budget they are random views and runs.
[[nodiscard]] std::vector<VerifiedView> sample_views(const Placement& placement, const ViewSpace& view_space, std::uint32_t count,
                                                     std::uint64_t seed);

}  // namespace standin
