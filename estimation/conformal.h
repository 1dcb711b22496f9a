// A split-conformal upper bound on rendering time (Vovk et al.; Lei et al. 2018): of the ratios measured / predicted on frames the fit had
// not seen, the ceil((n + 1) coverage)-th smallest is not exceeded by a further, exchangeable frame with at least that probability.
#pragma once

#include <vector>

#include "estimation/time_model.h"

namespace standin {

/// A frame's prediction by a model that has not seen it.
struct HeldOut {
  double predicted_ms = 0.0;
  double measured_ms = 0.0;  // > 0
};

/// So many frames are enough for a quantile of this coverage (99 for 99 %).
[[nodiscard]] std::size_t least_frames_for(double coverage);

/// Steps over predicted time, as many (at most 5) as leave each three times as many (with fewer, a quantile so high is hardly more than the
/// greatest ratio); with too few frames even for one step, the greatest ratio times kTooFewFactor. `held_out` holds at least one frame.
inline constexpr double kTooFewFactor = 1.25;
[[nodiscard]] std::vector<BoundStep> conformal_steps(std::vector<HeldOut> held_out, double coverage);

}  // namespace standin
