#include "estimation/learning_curve.h"

#include <gtest/gtest.h>

#include "estimation/self_test_frames.h"
#include "render/base/rng.h"

namespace standin {
namespace {

/// A frame every tenth of a second, 5 % noise, three scenes in turn.
std::vector<TimedFrame> frames_of(double seconds) {
  auto frames = self_test::exact_frames(21, static_cast<std::size_t>(10.0 * seconds));
  Rng rng(22);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].seconds = 0.1 * static_cast<double>(i + 1);
    frames[i].group = static_cast<std::uint32_t>(i % 3);
    frames[i].milliseconds *= rng.uniform(0.95, 1.05);
  }
  return frames;
}

TEST(LearningCurve, HasAPointAtEachDoublingAndAtTheEnd) {
  const auto frames = frames_of(47.0);
  const auto curve = learning_curve(frames, 0.99);
  ASSERT_EQ(curve.size(), 5U);
  const double seconds[] = {5.0, 10.0, 20.0, 40.0, 47.0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(curve[i].seconds, seconds[i], 1e-9);
    EXPECT_EQ(curve[i].frames, static_cast<std::uint32_t>(10.0 * seconds[i] + 0.5));
  }
  EXPECT_LT(curve[4].median_error, curve[0].median_error) << "more frames, less error";
}

TEST(LearningCurve, ItsLastPointIsTheFitItself) {
  const auto frames = frames_of(12.0);
  const FitSummary fit = fit_time_model(frames, 0.99);
  const LearningPoint last = learning_curve(frames, 0.99).back();
  EXPECT_EQ(last.median_error, fit.median_error);
  EXPECT_EQ(last.coverage, fit.measured_coverage);
  EXPECT_EQ(last.bound_over_measured_median, fit.bound_over_measured_median);
}

TEST(LearningCurve, HasNoPointWhereThereAreTooFewFrames) {
  EXPECT_TRUE(learning_curve({}, 0.99).empty());
  auto frames = frames_of(12.0);
  for (TimedFrame& frame : frames) frame.seconds *= 20.0;
  EXPECT_EQ(learning_curve(frames, 0.99).front().seconds, 40.0);
}

TEST(AccurateEnough, AsksForErrorAndCoverage) {
  FitSummary fit;
  fit.frames = 1500;  // a third of them of the designed scene
  fit.held_out_frames = 1000;
  fit.misses = 15;
  fit.median_error = 0.1;
  fit.model.coverage = 0.99;
  EXPECT_TRUE(accurate_enough(fit, 0.1));
  EXPECT_FALSE(accurate_enough(fit, 0.099));
  fit.misses = 16;
  EXPECT_FALSE(accurate_enough(fit, 0.1));
}

}  // namespace
}  // namespace standin
