// What more calibration buys: a calibration is an anytime process, and its error falls with the seconds of timed renders.
#pragma once

#include <cstdint>
#include <vector>

#include "estimation/calibrate.h"

namespace standin {

/// A fit to the first frames of each scene at 5, 10, 20 ... seconds, and to all of them; in that order. Errors and coverage as a
/// FitSummary's: held out. Seconds with too few frames for a fit have no point.
[[nodiscard]] std::vector<LearningPoint> learning_curve(const std::vector<TimedFrame>& frames, double coverage);

/// Whether a fit's held-out error is within the target and its held-out coverage does not speak against the stated one (most_misses). Asked
/// of one calibration again and again, it says yes a little too early.
[[nodiscard]] bool accurate_enough(const FitSummary& fit, double target_error);

}  // namespace standin
