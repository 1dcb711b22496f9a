#include "estimation/self_test_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace standin::self_test {

double normal(Rng& rng) {
  double sum = 0.0;
  for (int i = 0; i < 12; ++i) sum += rng.uniform();
  return sum - 6.0;
}

double feature_scale(std::size_t term) {
  return term == static_cast<std::size_t>(Term::kFrame) ? 1.0 : std::pow(10.0, static_cast<double>(2 + term % 5));
}

TimeModel true_model() {
  TimeModel model;
  for (std::size_t i = 0; i < kTermCount; ++i) model.milliseconds_per_unit[i] = static_cast<double>(2 + i % 3) / feature_scale(i);
  model.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)] = 0.3;
  return model;
}

std::vector<TimedFrame> exact_frames(std::uint64_t seed, std::size_t count, const TimeModel& truth) {
  std::vector<TimedFrame> frames(count);
  for (std::size_t row = 0; row < count; ++row) {
    Rng rng(seed, row);
    const double size = std::pow(10.0, rng.uniform(-2.0, 0.0));
    for (std::size_t i = 0; i < kTermCount; ++i) frames[row].features.value[i] = size * feature_scale(i) * rng.uniform();
    frames[row].features[Term::kFrame] = 1.0;
    frames[row].milliseconds = truth.predicted_ms(frames[row].features);
  }
  return frames;
}

FitProblem problem_of_columns(const std::vector<std::vector<double>>& columns, const std::vector<double>& costs) {
  FitProblem problem;
  problem.stages.assign(columns.size(), Stage::kGeometry);
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    double ms = 0.0;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      problem.features.push_back(columns[j][i]);
      ms += columns[j][i] * costs[j];
    }
    problem.milliseconds.push_back(ms);
  }
  return problem;
}

std::vector<double> random_column(std::uint64_t seed, std::size_t rows, double low, double high) {
  Rng rng(seed);
  std::vector<double> column(rows);
  for (double& value : column) value = rng.uniform(low, high);
  return column;
}

double coefficient_error(const TimeModel& model, const TimeModel& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < kTermCount; ++i)
    worst = std::max(worst, std::abs(model.milliseconds_per_unit[i] / truth.milliseconds_per_unit[i] - 1.0));
  return worst;
}

double coefficient_error(const FitResult& fit, const std::vector<double>& costs) {
  double worst = 0.0;
  for (std::size_t j = 0; j < costs.size(); ++j) worst = std::max(worst, std::abs(fit.milliseconds_per_unit[j] / costs[j] - 1.0));
  return worst;
}

double prediction_error(const FitProblem& problem, const FitResult& fit) {
  double worst = 0.0;
  for (std::size_t i = 0; i < problem.rows(); ++i) {
    double ms = 0.0;
    for (std::size_t j = 0; j < problem.terms(); ++j) ms += problem.features[i * problem.terms() + j] * fit.milliseconds_per_unit[j];
    worst = std::max(worst, std::abs(ms / problem.milliseconds[i] - 1.0));
  }
  return worst;
}

}  // namespace standin::self_test
