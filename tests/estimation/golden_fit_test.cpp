// The fit against the same problems solved in 50-digit arithmetic (tests/golden/make_time_fit.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimation/robust_fit.h"
#include "tests/support/golden.h"

namespace standin {
namespace {

using nlohmann::json;

// Of the gradient beside what makes it up (rho' |x| (|predicted| + |measured|), weighted): about 60 rows times the unit roundoff.
constexpr double kBackwardError = 2e-14;

std::vector<double> numbers(const json& list) {
  std::vector<double> values;
  for (const json& entry : list) values.push_back(entry.is_string() ? std::stod(entry.get<std::string>()) : entry.get<double>());
  return values;
}

Stage stage_named(const std::string& name) {
  return name == "shared" ? Stage::kShared : name == "geometry" ? Stage::kGeometry : Stage::kFill;
}

struct Vector {
  FitProblem problem;
  Combination combination;
  std::vector<double> coefficients, predicted_ms;
  double objective;

  explicit Vector(const json& entry)
      : combination(entry.at("combination") == "sum" ? Combination::kSum : Combination::kMax),
        coefficients(numbers(entry.at("milliseconds_per_unit"))),
        predicted_ms(numbers(entry.at("predicted_ms"))),
        objective(std::stod(entry.at("objective").get<std::string>())) {
    problem.features = numbers(entry.at("features"));
    problem.milliseconds = numbers(entry.at("milliseconds"));
    for (const json& stage : entry.at("stages")) problem.stages.push_back(stage_named(stage));
  }
};

struct Sums {
  double shared = 0.0, geometry = 0.0, fill = 0.0;
};

Sums stage_sums(const FitProblem& problem, std::size_t row, const std::vector<double>& c) {
  Sums sums;
  for (std::size_t j = 0; j < problem.terms(); ++j)
    (problem.stages[j] == Stage::kShared     ? sums.shared
     : problem.stages[j] == Stage::kGeometry ? sums.geometry
                                             : sums.fill) += problem.features[row * problem.terms() + j] * c[j];
  return sums;
}

double predicted_ms(const Sums& sums, Combination combination) {
  return sums.shared + (combination == Combination::kSum ? sums.geometry + sums.fill : std::max(sums.geometry, sums.fill));
}

/// Greatest pull on a coefficient that its bound does not hold, beside all that pulls on it.
double backward_error(const Vector& vector, const std::vector<double>& c) {
  const FitProblem& problem = vector.problem;
  std::vector<double> pull(problem.terms()), all(problem.terms());
  for (std::size_t i = 0; i < problem.rows(); ++i) {
    const Sums sums = stage_sums(problem, i, c);
    const double ms = problem.milliseconds[i], weight = 1.0 / (ms + kSmallFrameMs);
    const double r = (predicted_ms(sums, vector.combination) - ms) * weight;
    const double slope = 1.0 / (1.0 + r * r / (kLossScale * kLossScale));
    const Stage hidden = vector.combination == Combination::kSum ? Stage::kShared
                         : sums.geometry < sums.fill             ? Stage::kGeometry
                                                                 : Stage::kFill;
    for (std::size_t j = 0; j < problem.terms(); ++j) {
      if (vector.combination == Combination::kMax && problem.stages[j] == hidden) continue;
      const double x = problem.features[i * problem.terms() + j] * weight;
      pull[j] += slope * r * x;
      all[j] += slope * x * (predicted_ms(sums, vector.combination) + ms) * weight;
    }
  }
  double worst = 0.0;
  for (std::size_t j = 0; j < problem.terms(); ++j) worst = std::max(worst, (c[j] > 0.0 ? std::abs(pull[j]) : -pull[j]) / all[j]);
  return worst;
}

void expect_coefficients(const Vector& vector, const FitResult& fit, double relative, const std::string& name) {
  for (std::size_t j = 0; j < vector.coefficients.size(); ++j) {
    const double exact = vector.coefficients[j];
    EXPECT_NEAR(fit.milliseconds_per_unit[j], exact, relative * exact) << name << ", term " << j;
    EXPECT_EQ(fit.at_bound[j], exact == 0.0) << name << ", term " << j;
  }
}

TEST(TimeFit, AgreesWith50DigitsWhereThatIsWellPosed) {
  std::size_t well_posed = 0;
  for (const json& entry : test::golden_cases("time_fit.json")) {
    if (entry.at("ill_posed")) continue;
    ++well_posed;
    const Vector vector(entry);
    const FitResult fit = fit_robustly(vector.problem, {vector.combination});
    EXPECT_TRUE(fit.converged) << entry.at("name") << ": " << fit.stopped;
    expect_coefficients(vector, fit, 1e-8, entry.at("name"));
    EXPECT_NEAR(fit.objective, vector.objective, 1e-8 * vector.objective + 1e-24) << entry.at("name");
    EXPECT_LT(backward_error(vector, fit.milliseconds_per_unit), kBackwardError) << entry.at("name");
  }
  EXPECT_GE(well_posed, 12U);
}

// Coefficients of columns alike to the last digits are anyone's guess; what they predict together is not.
TEST(TimeFit, SolvesANearbyProblemWhereThatIsIllPosed) {
  std::size_t ill_posed = 0;
  for (const json& entry : test::golden_cases("time_fit.json")) {
    if (!entry.at("ill_posed")) continue;
    ++ill_posed;
    const Vector vector(entry);
    const FitResult fit = fit_robustly(vector.problem, {vector.combination});
    EXPECT_TRUE(fit.converged) << entry.at("name") << ": " << fit.stopped;
    EXPECT_GT(fit.condition_number, 1e6) << entry.at("name");
    EXPECT_LT(backward_error(vector, fit.milliseconds_per_unit), kBackwardError) << entry.at("name");
    for (std::size_t i = 0; i < vector.problem.rows(); ++i)
      EXPECT_NEAR(predicted_ms(stage_sums(vector.problem, i, fit.milliseconds_per_unit), vector.combination) / vector.predicted_ms[i], 1.0,
                  1e-13)
          << entry.at("name") << ", row " << i;
  }
  EXPECT_GE(ill_posed, 4U);
}

}  // namespace
}  // namespace standin
