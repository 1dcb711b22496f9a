#include "estimation/time_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TimeModel model_with(std::vector<BoundStep> steps) {
  TimeModel model;
  model.bound_steps = std::move(steps);
  return model;
}

TEST(TimeModel, KeepsPixelWorkApart) {
  TimeModel model = model_with({{kInfinity, 1.0}});
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kDraws)] = 0.5;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kMaskedPixels)] = 0.25;
  Features features;
  features[Term::kDraws] = 3.0;
  features[Term::kMaskedPixels] = 8.0;
  const Cost cost = model.cost(features);
  EXPECT_DOUBLE_EQ(cost.fixed_ms, 1.5);
  EXPECT_DOUBLE_EQ(cost.pixel_ms, 2.0);
  EXPECT_DOUBLE_EQ(model.predicted_ms(cost), 3.5);
}

// A view full of impostors must not count as free because the originals' pixels have a cap.
TEST(TimeModel, CapsThePixelsOfOriginalsByTheCostliestKind) {
  TimeModel model = model_with({{kInfinity, 1.0}});
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kPlainPixels)] = 0.1;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTexturedPixels)] = 0.2;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorPixels)] = 0.25;
  EXPECT_DOUBLE_EQ(model.most_pixel_ms(std::array{Term::kPlainPixels, Term::kTexturedPixels}, 10.0), 2.0);
  EXPECT_DOUBLE_EQ(model.most_pixel_ms(std::array{Term::kPlainPixels}, 10.0), 1.0);
  EXPECT_DOUBLE_EQ(model.most_pixel_ms({}, 10.0), 0.0);
  Features features;
  features[Term::kImpostorPixels] = 100.0;
  EXPECT_DOUBLE_EQ(model.cost(features).fixed_ms, 25.0);
}

// By hand: shared 2, geometry 3 x 0.5, fill 8 x 0.25 + 4 x 0.5.
TEST(TimeModel, TakesTheLongerStageWhereStagesOverlap) {
  TimeModel model = model_with({{kInfinity, 1.0}});
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)] = 2.0;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kDraws)] = 0.5;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kMaskedPixels)] = 0.25;
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorPixels)] = 0.5;
  Features frame = frame_features();
  frame[Term::kDraws] = 3.0;
  frame[Term::kMaskedPixels] = 8.0;
  frame[Term::kImpostorPixels] = 4.0;
  EXPECT_DOUBLE_EQ(model.predicted_ms(frame), 7.5);
  model.combination = Combination::kMax;
  EXPECT_DOUBLE_EQ(model.predicted_ms(frame), 6.0);
  frame[Term::kDraws] = 100.0;
  EXPECT_DOUBLE_EQ(model.predicted_ms(frame), 52.0);
  EXPECT_DOUBLE_EQ(model.predicted_ms(model.cost(frame)), 56.0) << "what regions are bounded by";
}

TEST(TimeModel, MoreOfAnyFeatureNeverCostsLess) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed, 3);
    TimeModel model = model_with({{kInfinity, 1.0}});
    model.combination = seed % 2 == 0 ? Combination::kSum : Combination::kMax;
    Features frame;
    for (std::size_t i = 0; i < kTermCount; ++i) {
      model.milliseconds_per_unit[i] = std::pow(10.0, rng.uniform(-9.0, 3.0));
      frame.value[i] = std::pow(10.0, rng.uniform(-3.0, 9.0));
    }
    for (std::size_t i = 0; i < kTermCount; ++i) {
      Features more = frame;
      more.value[i] *= 1.0 + rng.uniform();
      ASSERT_GE(model.predicted_ms(more), model.predicted_ms(frame)) << "seed " << seed << ", " << term_name(static_cast<Term>(i));
    }
  }
}

// Regions of a machine whose stages overlap are bounded by the sum.
TEST(TimeModel, SumIsNeverLessThanTheLongerStage) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed, 2);
    TimeModel model = model_with({{kInfinity, 1.0}});
    Features frame;
    for (std::size_t i = 0; i < kTermCount; ++i) {
      model.milliseconds_per_unit[i] = std::pow(10.0, rng.uniform(-9.0, 3.0));
      frame.value[i] = rng.uniform() < 0.3 ? 0.0 : std::pow(10.0, rng.uniform(-3.0, 9.0));
    }
    const double sum_ms = model.predicted_ms(frame);
    model.combination = Combination::kMax;
    ASSERT_LE(model.predicted_ms(frame), sum_ms * (1.0 + 1e-14)) << "seed " << seed;
  }
}

TEST(TimeModel, BoundStaysLevelUntilALesserFactorHasCaughtUp) {
  const TimeModel model = model_with({{10.0, 2.0}, {kInfinity, 1.25}});
  EXPECT_DOUBLE_EQ(model.bound_ms(0.0), 0.0);
  EXPECT_DOUBLE_EQ(model.bound_ms(8.0), 16.0);
  EXPECT_DOUBLE_EQ(model.bound_ms(10.0), 20.0);
  EXPECT_DOUBLE_EQ(model.bound_ms(16.0), 20.0);
  EXPECT_DOUBLE_EQ(model.bound_ms(20.0), 25.0);
}

TEST(TimeModel, BudgetsByHand) {
  const TimeModel falling = model_with({{10.0, 2.0}, {kInfinity, 1.25}});
  EXPECT_DOUBLE_EQ(falling.predicted_budget_ms(16.0), 8.0);
  EXPECT_DOUBLE_EQ(falling.predicted_budget_ms(20.0), 16.0);
  EXPECT_DOUBLE_EQ(falling.predicted_budget_ms(25.0), 20.0);
  const TimeModel rising = model_with({{10.0, 1.25}, {kInfinity, 2.0}});
  EXPECT_EQ(rising.predicted_budget_ms(15.0), std::nextafter(10.0, 0.0));  // at 10 the bound jumps from 12.5 to 20
  EXPECT_DOUBLE_EQ(rising.predicted_budget_ms(20.0), 10.0);
  EXPECT_LT(falling.predicted_budget_ms(-1.0), 0.0);
  EXPECT_LT(falling.predicted_budget_ms(std::nan("")), 0.0);
  EXPECT_EQ(falling.predicted_budget_ms(0.0), 0.0);
}

std::vector<BoundStep> random_steps(Rng& rng) {
  std::vector<BoundStep> steps;
  double until_ms = 0.0;
  for (std::uint64_t i = rng.below(5); i-- > 0;) {
    until_ms += std::pow(10.0, rng.uniform(-2.0, 2.0));
    steps.push_back({until_ms, rng.uniform(0.8, 3.0)});
  }
  steps.push_back({kInfinity, rng.uniform(0.8, 3.0)});
  return steps;
}

TEST(TimeModel, BoundIsMonotone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed);
    const TimeModel model = model_with(random_steps(rng));
    for (int i = 0; i < 200; ++i) {
      double lesser = std::pow(10.0, rng.uniform(-3.0, 3.0));
      if (i < 20) lesser = model.bound_steps.front().until_ms;
      if (std::isinf(lesser)) continue;
      ASSERT_LE(model.bound_ms(lesser), model.bound_ms(lesser * (1.0 + rng.uniform()))) << "seed " << seed;
      ASSERT_LE(model.bound_ms(std::nextafter(lesser, 0.0)), model.bound_ms(lesser)) << "seed " << seed;
    }
  }
}

TEST(TimeModel, BudgetIsTheLastPredictionWithinIt) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Rng rng(seed, 1);
    const TimeModel model = model_with(random_steps(rng));
    double budget_ms = std::pow(10.0, rng.uniform(-3.0, 3.0));
    // On a step's border, and one representable number beside it.
    if (seed % 3 != 0) budget_ms = model.bound_ms(std::min(1e3, model.bound_steps[rng.below(model.bound_steps.size())].until_ms));
    if (seed % 3 == 2) budget_ms = std::nextafter(budget_ms, rng.uniform() < 0.5 ? 0.0 : kInfinity);
    const double predicted_ms = model.predicted_budget_ms(budget_ms);
    ASSERT_LE(model.bound_ms(predicted_ms), budget_ms) << "seed " << seed;
    ASSERT_GT(model.bound_ms(std::nextafter(predicted_ms, kInfinity)), budget_ms) << "seed " << seed;
  }
}

}  // namespace
}  // namespace standin
