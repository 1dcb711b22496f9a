#include "estimation/conformal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/base/rng.h"

namespace standin {
namespace {

std::vector<HeldOut> noisy_frames(std::uint64_t seed, int count) {
  Rng rng(seed);
  std::vector<HeldOut> frames;
  for (int i = 0; i < count; ++i) {
    const double predicted_ms = std::pow(10.0, rng.uniform(-1.0, 2.0));
    const double noise = (0.3 + 1.0 / (1.0 + predicted_ms)) * (rng.uniform() + rng.uniform() - 1.0);
    frames.push_back({predicted_ms, predicted_ms * std::exp(noise)});
  }
  return frames;
}

TEST(ConformalSteps, TakeTheRankedRatio) {
  // 19 ratios 1.1 .. 2.9: rank ceil(20 * 0.9) = 18.
  std::vector<HeldOut> frames;
  for (int i = 1; i <= 19; ++i) frames.push_back({10.0, 10.0 + i});
  const auto steps = conformal_steps(frames, 0.9);  // equal predictions stay in one step
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_DOUBLE_EQ(steps[0].factor, 2.8);
  EXPECT_TRUE(std::isinf(steps[0].until_ms));
}

TEST(ConformalSteps, OfTooFewFramesStandAboveTheGreatestRatio) {
  const auto steps = conformal_steps({{1.0, 1.0}, {2.0, 4.0}, {3.0, 3.0}}, 0.99);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_DOUBLE_EQ(steps[0].factor, kTooFewFactor * 2.0);
}

// One of four scenes is off by a half more: pooled, the 90 % bound would leave half of its frames out.
TEST(ConformalSteps, CoverEveryGroupByItself) {
  Rng rng(5);
  std::vector<HeldOut> frames;
  for (std::uint32_t i = 0; i < 800; ++i) {
    const double predicted_ms = std::pow(10.0, rng.uniform(-1.0, 2.0));
    frames.push_back({predicted_ms, predicted_ms * rng.uniform(0.8, 1.2) * (i % 4 == 2 ? 1.5 : 1.0), i % 4});
  }
  TimeModel model;
  model.bound_steps = conformal_steps(frames, 0.9);
  std::array<int, 4> covered{};
  for (const HeldOut& frame : frames) covered.at(frame.group) += frame.measured_ms <= model.bound_ms(frame.predicted_ms) ? 1 : 0;
  for (const int count : covered) EXPECT_GE(count, 180);
  EXPECT_LT(covered[2], 195) << "no further than it takes";
}

TEST(ConformalSteps, AGroupTooSmallForItsOwnQuantileCountsByItsWorst) {
  std::vector<HeldOut> frames(200, HeldOut{10.0, 10.0, 0});
  frames.push_back({10.0, 20.0, 1});
  const auto steps = conformal_steps(frames, 0.99);
  EXPECT_DOUBLE_EQ(steps.back().factor, kTooFewFactor * 2.0);
}

TEST(ConformalSteps, SayHowManyFramesAreEnough) {
  EXPECT_EQ(least_frames_for(0.99), 99U);
  EXPECT_EQ(least_frames_for(0.9), 9U);
  EXPECT_EQ(least_frames_for(0.5), 1U);
}

TEST(ConformalSteps, AscendAndEndInInfinity) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto steps = conformal_steps(noisy_frames(seed, 600), 0.95);
    ASSERT_EQ(steps.size(), 10U);
    for (std::size_t i = 1; i < steps.size(); ++i) ASSERT_LT(steps[i - 1].until_ms, steps[i].until_ms);
    ASSERT_TRUE(std::isinf(steps.back().until_ms));
  }
}

TEST(ConformalSteps, CoverFreshFramesAsOftenAsStated) {
  for (const double coverage : {0.9, 0.99}) {
    double covered = 0.0, frames = 0.0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      TimeModel model;
      model.bound_steps = conformal_steps(noisy_frames(seed, 700), coverage);
      for (const HeldOut& frame : noisy_frames(seed + 1000, 500)) {
        covered += frame.measured_ms <= model.bound_ms(frame.predicted_ms) ? 1.0 : 0.0;
        frames += 1.0;
      }
    }
    EXPECT_GE(covered / frames, coverage - 0.002);
    EXPECT_LE(covered / frames, coverage + 0.5 * (1.0 - coverage) + 0.01) << "a bound that always holds is no measure";
  }
}

TEST(ConformalSteps, SurviveAPredictionOfNothing) {
  for (const auto& step : conformal_steps({{0.0, 1.0}, {1.0, 1.0}}, 0.9)) EXPECT_TRUE(std::isfinite(step.factor));
}

}  // namespace
}  // namespace standin
