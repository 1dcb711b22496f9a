// Calibration: timed renders of random object clusters, whole frames and baked impostors (thesis 5.8.1, Fig. 5.5 and 5.6), a non-negative
// robust fit (the only Ceres), held-out error and a conformal upper bound.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "render/base/work.h"
#include "render/device/frame_timer.h"

namespace standin {

/// One timed frame; `group` is the scene it came from (the bound leaves one out at a time).
struct TimedFrame {
  Features features;  // estimate for its view
  double milliseconds = 0.0;
  std::uint32_t group = 0;
  bool designed = false;  // of the designed scene: fitted, never held out, and no part of what the bound is calibrated on
  // For diagnosis; the fit asks for the spread alone.
  double spread = 0.0;         // of the repeats, relative
  double seconds = 0.0;        // of timed renders so far, since the calibration began
  double passed_pixels = 0.0;  // counted by the device, where that was asked for
};

/// Frames whose repeats disagree by more are not fitted; they are counted.
inline constexpr double kMostSpread = 0.2;
[[nodiscard]] std::vector<TimedFrame> steady_frames(const std::vector<TimedFrame>& frames);

/// Fewer steady frames to judge by (held_out.h) are not fitted.
inline constexpr std::size_t kLeastFrames = 20;
[[nodiscard]] bool enough_frames(const std::vector<TimedFrame>& frames);

/// What the caller's timer is to do for each sample: fewer repeats than a verification's, since many rough samples teach a fit more than
/// few exact ones. The first repeat takes the place of a warm-up; the median is then the slower of the other two, half a noise width on the
/// safe side.
inline constexpr int kCalibrationRepeats = 3;
inline constexpr int kCalibrationWarmUp = 0;

struct CalibrationOptions {
  double seconds = 45.0;  // of timed renders (baking and set-up not counted)
  std::uint64_t seed = 1;
  bool count_passed_pixels = false;
};

/// Seconds after which a calibration may look at what it has: multiples of this.
inline constexpr double kLookEvery_s = 5.0;
/// Asked then; true ends the calibration.
using Enough = std::function<bool(const std::vector<TimedFrame>&)>;

/// A scene to time frames of.
struct TrainingScene {
  Scene scene;
  bool designed = false;
};

/// Timed frames of the scenes, taking turns (group: index of the scene): clusters, whole frames, with and without impostors. The context
/// must be current. Which frames are timed depends on the seed alone; fewer seconds stop earlier.
[[nodiscard]] std::vector<TimedFrame> sample_frames(std::span<const TrainingScene> scenes, Context& context, FrameTimer& timer,
                                                    const Camera& camera, const CalibrationOptions& options, const Enough& enough,
                                                    const WorkBudget& budget);

/// A term that takes part in the fit.
struct FittedTerm {
  std::string name;
  double milliseconds_per_unit = 0.0;
  std::optional<double> relative_standard_error;  // none at 0
  bool at_bound = false;                          // 0, since the frames would have it negative
};

struct FitSummary {
  TimeModel model;
  std::string stopped;            // how the solver ended
  double condition_number = 1.0;  // of the weighted, scaled columns of the terms above 0
  std::vector<FittedTerm> terms;
  std::vector<double> relative_covariance;  // of the terms' relative errors, terms x terms; 0 for terms at 0, infinity where unknown
  double sum_error = 0.0;  // mean held-out error where the stages' times add up, and where they overlap: model.combination is the choice
  double max_error = 0.0;
  std::uint32_t frames = 0;
  std::uint32_t unsteady_frames = 0;  // not fitted: kMostSpread
  std::uint32_t held_out_frames = 0;  // of the fitted ones, those that errors and coverage are about
  std::uint32_t misses = 0;           // of these, above the bound
  double median_error = 0.0;          // held out, relative
  double p90_error = 0.0;
  double measured_coverage = 0.0;  // held out
  double bound_over_measured_median = 0.0;
  std::vector<std::string> left_out;
  std::vector<std::string> warnings;  // what a user can do something about
};

/// Deterministic. Terms the frames cannot support are dropped and named. Stages add up unless the held-out error speaks for an overlap
/// (held_out.h). Errors and bound are those on frames held out, the designed ones in every fit: scene by scene, or in five random folds
/// where there is one scene only (or one that no other can stand in for). Throws Failure(kBadUsage) naming the row for a time that is not
/// finite and positive, or when there are too few steady frames.
[[nodiscard]] FitSummary fit_time_model(const std::vector<TimedFrame>& frames, double coverage);

/// Frames that the bound may miss, of so many, before they speak against the stated coverage: more misses would come about in at most one
/// case of twenty (one-sided binomial test).
[[nodiscard]] std::uint32_t most_misses(std::uint32_t frames, double coverage);

/// How a model does on frames it has not seen (calibrate --evaluate).
struct Evaluation {
  std::uint32_t frames = 0;
  std::uint32_t unsteady_frames = 0;  // not among them: kMostSpread
  double median_error = 0.0;
  double p90_error = 0.0;
  double coverage = 0.0;
  std::uint32_t misses = 0;
  double bound_over_measured_median = 0.0;
};
[[nodiscard]] Evaluation evaluate(const TimeModel& model, const std::vector<TimedFrame>& frames);

}  // namespace standin
