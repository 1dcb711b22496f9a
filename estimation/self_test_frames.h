// Frames with known costs for the self test; internal to it.
#pragma once

#include <string>
#include <vector>

#include "estimation/calibrate.h"
#include "estimation/robust_fit.h"
#include "render/base/rng.h"

namespace standin::self_test {

/// Standard normal, near enough: the sum of twelve uniform numbers.
[[nodiscard]] double normal(Rng& rng);

/// Costs of all terms, such that each matters: features of term j are about feature_scale(j) large.
[[nodiscard]] TimeModel true_model();
[[nodiscard]] double feature_scale(std::size_t term);

/// Frames of two decades of size, each feature independent of the others, with their exact times.
[[nodiscard]] std::vector<TimedFrame> exact_frames(std::uint64_t seed, std::size_t count, const TimeModel& truth = true_model());

/// A fit's input with known coefficients: `columns` (of equal length), exact times, all terms geometry.
[[nodiscard]] FitProblem problem_of_columns(const std::vector<std::vector<double>>& columns, const std::vector<double>& costs);
[[nodiscard]] std::vector<double> random_column(std::uint64_t seed, std::size_t rows, double low, double high);

/// Greatest relative error of the coefficients.
[[nodiscard]] double coefficient_error(const TimeModel& model, const TimeModel& truth);
[[nodiscard]] double coefficient_error(const FitResult& fit, const std::vector<double>& costs);
/// Greatest relative error of the rows' predictions.
[[nodiscard]] double prediction_error(const FitProblem& problem, const FitResult& fit);

}  // namespace standin::self_test
