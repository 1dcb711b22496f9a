#include "estimation/robust_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

struct Truth {
  FitProblem problem;
  std::vector<double> milliseconds_per_unit;
};

double normal(Rng& rng) {
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) sum += rng.uniform();
  return sum - 6.0;
}

double predicted_ms(const FitProblem& problem, std::size_t row, const std::vector<double>& c, Combination combination) {
  double part[3] = {};
  for (std::size_t j = 0; j < problem.terms(); ++j)
    part[static_cast<std::size_t>(problem.stages[j])] += problem.features[row * problem.terms() + j] * c[j];
  return part[0] + (combination == Combination::kSum ? part[1] + part[2] : std::max(part[1], part[2]));
}

/// A shared constant and terms of both stages by turns, of scales 1e-6 to 1e6; times with relative noise, a tenth of them far off.
Truth random_problem(std::uint64_t seed, std::size_t rows, std::size_t terms, Combination combination, double noise) {
  Rng rng(seed);
  Truth truth;
  std::vector<double> scale;
  for (std::size_t j = 0; j < terms; ++j) {
    truth.problem.stages.push_back(j == 0 ? Stage::kShared : j % 2 == 1 ? Stage::kGeometry : Stage::kFill);
    scale.push_back(j == 0 ? 1.0 : std::pow(10.0, rng.uniform(-6.0, 6.0)));
    truth.milliseconds_per_unit.push_back(rng.uniform(0.5, 5.0) / scale.back());
  }
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < terms; ++j) truth.problem.features.push_back(scale[j] * (j == 0 ? 1.0 : std::pow(rng.uniform(), 3.0)));
    truth.problem.milliseconds.push_back(1.0);
    double ms = predicted_ms(truth.problem, i, truth.milliseconds_per_unit, combination) * std::exp(noise * normal(rng));
    if (noise > 0.0 && i % 10 == 3) ms *= 4.0;
    truth.problem.milliseconds.back() = ms;
  }
  return truth;
}

/// Greatest pull on a coefficient against the bounds, relative to what pulls on it at all.
double worst_pull(const FitProblem& problem, const FitResult& fit, Combination combination) {
  const std::size_t n = problem.terms();
  std::vector<double> pull(n), all(n);
  for (std::size_t i = 0; i < problem.rows(); ++i) {
    const double weight = 1.0 / (problem.milliseconds[i] + kSmallFrameMs);
    const double r = (predicted_ms(problem, i, fit.milliseconds_per_unit, combination) - problem.milliseconds[i]) * weight;
    double part[3] = {};
    for (std::size_t j = 0; j < n; ++j)
      part[static_cast<std::size_t>(problem.stages[j])] += problem.features[i * n + j] * fit.milliseconds_per_unit[j];
    for (std::size_t j = 0; j < n; ++j) {
      if (combination == Combination::kMax && problem.stages[j] == (part[1] < part[2] ? Stage::kGeometry : Stage::kFill)) continue;
      const double one = r / (1.0 + r * r / (kLossScale * kLossScale)) * problem.features[i * n + j] * weight;
      pull[j] += one;
      all[j] += std::abs(one);
    }
  }
  double worst = 0.0;
  for (std::size_t j = 0; j < n; ++j)
    if (all[j] > 0.0) worst = std::max(worst, (fit.milliseconds_per_unit[j] > 0.0 ? std::abs(pull[j]) : -pull[j]) / all[j]);
  return worst;
}

TEST(RobustFit, RecoversTheTruthBehindExactTimes) {
  for (const Combination combination : {Combination::kSum, Combination::kMax})
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const Truth truth = random_problem(seed, 150, 8, combination, 0.0);
      const FitResult fit = fit_robustly(truth.problem, {combination});
      EXPECT_TRUE(fit.converged) << fit.stopped;
      for (std::size_t j = 0; j < 8; ++j)
        EXPECT_NEAR(fit.milliseconds_per_unit[j] / truth.milliseconds_per_unit[j], 1.0, 1e-10)
            << "seed " << seed << (combination == Combination::kMax ? ", max" : "");
    }
}

TEST(RobustFit, EndsWhereNothingPullsButTheBounds) {
  std::size_t bounded = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Truth truth = random_problem(seed, 40 + 4 * seed, 3 + seed % 10, Combination::kSum, 0.02 + 0.01 * static_cast<double>(seed % 8));
    if (seed % 2 == 1)  // terms that cost nothing, or would have to cost less
      for (std::size_t i = 0; i < truth.problem.rows(); ++i) {
        double& ms = truth.problem.milliseconds[i];
        ms = std::max(0.05, ms - 1.3 * truth.milliseconds_per_unit[1] * truth.problem.features[i * truth.problem.terms() + 1]);
      }
    const FitResult fit = fit_robustly(truth.problem, {});
    EXPECT_TRUE(fit.converged) << "seed " << seed << ": " << fit.stopped;
    EXPECT_LT(worst_pull(truth.problem, fit, Combination::kSum), 1e-10) << "seed " << seed << ": " << fit.stopped;
    bounded += static_cast<std::size_t>(std::count(fit.at_bound.begin(), fit.at_bound.end(), true));
  }
  EXPECT_GT(bounded, 20U) << "the test could not fail";
}

// A maximum has kinks: a fit may rightly end in one, where no gradient vanishes.
TEST(RobustFit, OfALongerStageEndsWhereNothingPullsOrInAKink) {
  std::size_t kinks = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Truth truth = random_problem(seed, 200, 6, Combination::kMax, 0.05);
    const FitResult fit = fit_robustly(truth.problem, {Combination::kMax});
    if (!fit.converged) {
      ++kinks;
      continue;
    }
    EXPECT_LT(worst_pull(truth.problem, fit, Combination::kMax), 1e-10) << "seed " << seed;
  }
  std::printf("%zu of 40 fits end in a kink\n", kinks);
  EXPECT_LT(kinks, 20U);
}

TEST(RobustFit, PerturbingTheEndNeverLowersTheObjective) {
  const Truth truth = random_problem(7, 200, 6, Combination::kSum, 0.05);
  const FitResult fit = fit_robustly(truth.problem, {});
  const auto objective = [&](const std::vector<double>& c) {
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.problem.rows(); ++i) {
      const double ms = truth.problem.milliseconds[i];
      const double r = (predicted_ms(truth.problem, i, c, Combination::kSum) - ms) / (ms + kSmallFrameMs);
      sum += 0.5 * kLossScale * kLossScale * std::log1p(r * r / (kLossScale * kLossScale));
    }
    return sum;
  };
  EXPECT_NEAR(objective(fit.milliseconds_per_unit), fit.objective, 1e-12 * fit.objective);
  Rng rng(7);
  for (int i = 0; i < 1000; ++i) {
    std::vector<double> c = fit.milliseconds_per_unit;
    const double reach = std::pow(10.0, rng.uniform(-6.0, -1.0));
    for (double& value : c) value *= 1.0 + rng.uniform(-reach, reach);
    ASSERT_GE(objective(c), fit.objective * (1.0 - 1e-12));
  }
}

// Features within a factor of four, and one stage well above the other in each row: differences of a finite step meet no rounding and no
// kink.
TEST(RobustFit, ItsCostFunctionsPassCeresGradientChecker) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const Combination combination : {Combination::kSum, Combination::kMax}) {
      Truth truth = random_problem(seed, 60, 7, combination, 0.0);
      Rng rng(seed, 1);
      for (std::size_t i = 0; i < 60; ++i) {
        for (std::size_t j = 0; j < 7; ++j)
          truth.problem.features[7 * i + j] =
              rng.uniform(0.5, 1.0) * (truth.problem.stages[j] == (i % 2 == 1 ? Stage::kFill : Stage::kGeometry) ? 1.0 : 0.25);
        truth.problem.milliseconds[i] = rng.uniform(1.0, 2.0);
      }
      for (const double size : {0.3, 1.0, 3.0})
        EXPECT_TRUE(gradients_agree(truth.problem, combination, std::vector<double>(7, size), 1e-6)) << "seed " << seed << ", " << size;
    }
}

// The standard error says how far off the truth a coefficient is: in noise, about two of three are within one.
TEST(RobustFit, StandardErrorsAreHonest) {
  double within = 0.0, all = 0.0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Truth truth = random_problem(seed, 300, 5, Combination::kSum, 0.0);
    Rng rng(seed, 1);
    for (double& ms : truth.problem.milliseconds) ms *= 1.0 + 0.03 * normal(rng);
    const FitResult fit = fit_robustly(truth.problem, {});
    for (std::size_t j = 0; j < 5; ++j) {
      const double off = std::abs(fit.milliseconds_per_unit[j] - truth.milliseconds_per_unit[j]) / fit.milliseconds_per_unit[j];
      if (off < fit.relative_standard_error[j]) ++within;
      ++all;
    }
  }
  EXPECT_NEAR(within / all, 0.68, 0.08);
}

// Against repeated draws of the noise: how two coefficients err together.
TEST(RobustFit, CovarianceIsThatOfRepeatedFits) {
  const auto columns = [](Rng& rng) {
    const double shared = rng.uniform();
    return std::pair{shared + 0.3 * rng.uniform(), shared + 0.3 * rng.uniform()};
  };
  double together = 0.0, stated = 0.0;
  constexpr int kDraws = 400;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    Rng rows(99), noise(draw, 5);
    FitProblem problem{{}, {}, {Stage::kGeometry, Stage::kGeometry}};
    for (int i = 0; i < 200; ++i) {
      const auto [a, b] = columns(rows);
      problem.features.insert(problem.features.end(), {a, b});
      problem.milliseconds.push_back((3.0 * a + 2.0 * b) * (1.0 + 0.02 * normal(noise)));
    }
    const FitResult fit = fit_robustly(problem, {});
    together += (fit.milliseconds_per_unit[0] / 3.0 - 1.0) * (fit.milliseconds_per_unit[1] / 2.0 - 1.0) / kDraws;
    stated += fit.relative_covariance[1] / kDraws;
    ASSERT_EQ(fit.relative_covariance[1], fit.relative_covariance[2]);
    ASSERT_DOUBLE_EQ(std::sqrt(fit.relative_covariance[3]), fit.relative_standard_error[1]);
  }
  EXPECT_LT(stated, 0.0);
  EXPECT_NEAR(together / stated, 1.0, 0.2);
}

TEST(RobustFit, ConditionNumberByHand) {
  // Two columns of length 1 at 60 degrees: singular values sqrt(1 +- 1/2). Exact times leave every weight at 1.
  FitProblem problem{{1.0, 0.5, 0.0, std::sqrt(0.75)}, {1.0, 1.0}, {Stage::kGeometry, Stage::kGeometry}};
  for (std::size_t i = 0; i < 2; ++i) problem.milliseconds[i] = problem.features[2 * i] + problem.features[2 * i + 1];
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) problem.features[2 * i + j] *= problem.milliseconds[i] + kSmallFrameMs;
  const FitResult fit = fit_robustly(problem, {});
  EXPECT_NEAR(fit.condition_number, std::sqrt(3.0), 1e-2);
  EXPECT_TRUE(std::isinf(fit.relative_standard_error[0])) << "as many terms as rows leave no error to estimate";
}

TEST(RobustFit, SpreadRowsGiveEachTermItsShare) {
  FitProblem problem;
  problem.stages = {Stage::kShared, Stage::kGeometry, Stage::kFill};
  for (std::size_t i = 0; i < 10'000; ++i) {
    problem.features.insert(problem.features.end(), {1.0, i % 3000 == 17 ? 1.0 : 0.0, i > 9000 ? 1.0 : 0.0});
    problem.milliseconds.push_back(1.0);
  }
  const auto rows = spread_rows(problem, 400);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  EXPECT_LE(rows.size(), 400U);
  EXPECT_GE(rows.size(), 150U);
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [](std::size_t i) { return i % 3000 == 17; }), 4);
  EXPECT_GE(std::count_if(rows.begin(), rows.end(), [](std::size_t i) { return i > 9000; }), 100);
  EXPECT_EQ(spread_rows(problem, 10'000).size(), 10'000U);
}

TEST(RobustFit, RefusesWhatIsNoProblem) {
  EXPECT_THROW((void)fit_robustly({}, {}), Failure);
  EXPECT_THROW((void)fit_robustly({{}, {1.0}, {}}, {}), Failure);
  EXPECT_THROW((void)fit_robustly({{1.0, 2.0}, {1.0}, {Stage::kShared}}, {}), Failure);
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)fit_robustly({{1.0, bad}, {1.0, 1.0}, {Stage::kShared}}, {}), Failure);
    EXPECT_THROW((void)fit_robustly({{1.0, 1.0}, {1.0, bad}, {Stage::kShared}}, {}), Failure);
  }
}

}  // namespace
}  // namespace standin
