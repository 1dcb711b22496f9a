#include "estimation/learning_curve.h"

namespace standin {
namespace {

constexpr double kFirstPoint_s = 5.0;

std::vector<TimedFrame> first_seconds(const std::vector<TimedFrame>& frames, double seconds) {
  std::vector<TimedFrame> first;
  for (const TimedFrame& frame : frames)
    if (frame.seconds <= seconds) first.push_back(frame);
  return first;
}

}  // namespace

std::vector<LearningPoint> learning_curve(const std::vector<TimedFrame>& frames, double coverage) {
  std::vector<LearningPoint> curve;
  const auto add = [&](double seconds, const std::vector<TimedFrame>& first) {
    if (!enough_frames(first)) return;
    const FitSummary fit = fit_time_model(first, coverage);
    curve.push_back({seconds, fit.frames, fit.median_error, fit.p90_error, fit.measured_coverage, fit.bound_over_measured_median});
  };
  const double all_s = frames.empty() ? 0.0 : frames.back().seconds;
  for (double seconds = kFirstPoint_s; seconds < all_s; seconds *= 2.0) add(seconds, first_seconds(frames, seconds));
  add(all_s, frames);
  return curve;
}

bool accurate_enough(const FitSummary& fit, double target_error) {
  return fit.median_error <= target_error && fit.misses <= most_misses(fit.held_out_frames, fit.model.coverage);
}

}  // namespace standin
