// A split-conformal upper bound on rendering time (Vovk et al.; Lei et al. 2018): of the ratios measured / predicted on frames the fit had
// not seen, the ceil((n + 1) coverage)-th smallest is not exceeded by a further, exchangeable frame with at least that probability.
//
// Frames of a new scene are not exchangeable with those of others: scenes differ in how far a model is off. So each group, held out as a
// whole, must be covered by itself, not only all of them on average: the steps stand as high as the group that needs most.
#pragma once

#include <cstdint>
#include <vector>

#include "estimation/time_model.h"

namespace standin {

/// A frame's prediction by a model that has not seen it.
struct HeldOut {
  double predicted_ms = 0.0;
  double measured_ms = 0.0;  // > 0
  std::uint32_t group = 0;   // its scene
};

/// So many frames are enough for a quantile of this coverage (99 for 99 %).
[[nodiscard]] std::size_t least_frames_for(double coverage);

/// Steps over predicted time, as many (at most 10) as leave each twice as many (at 99 %: the greatest ratio of 198 frames, which leaves out
/// more than 2 % of all frames in one case of 55, as the second greatest of 297 does), then raised for the group that needs most. Where
/// frames are too few even for one step, or a group's for a quantile of its own, the greatest ratio counts times kTooFewFactor. `held_out`
/// holds at least one frame.
inline constexpr double kTooFewFactor = 1.25;
[[nodiscard]] std::vector<BoundStep> conformal_steps(std::vector<HeldOut> held_out, double coverage);

}  // namespace standin
