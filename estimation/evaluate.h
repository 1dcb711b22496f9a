// Error and coverage of predictions on frames that the model has not seen.
#pragma once

#include <vector>

#include "estimation/calibrate.h"
#include "estimation/conformal.h"

namespace standin {

/// Throws Failure(kBadUsage) naming the first row whose time is not positive and finite or whose features are not finite and >= 0.
void check_frames(const std::vector<TimedFrame>& frames);

/// `bounds_ms[i]` is the bound on frame i; at least one frame.
[[nodiscard]] Evaluation summarise(const std::vector<HeldOut>& frames, const std::vector<double>& bounds_ms);

}  // namespace standin
