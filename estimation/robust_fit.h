// The robust, non-negative fit behind calibration: thesis 5.8.1 fits by plain least squares, which a few disturbed frames spoil and which
// may find negative costs.
//
// Minimised over coefficients c >= 0 is the sum over rows of rho(r^2), where r = (predicted - measured) / (measured + kSmallFrameMs) and
// rho is Cauchy's loss, b log(1 + r^2 / b) with b = kLossScale^2: past that scale a row's pull fades. Columns are scaled to one length
// first, so features may be any number of orders of magnitude apart. The way there: a convex loss leads into the basin, Ceres follows with
// Cauchy's (both over some 1,500 rows that represent all), and sequential least squares over all rows ends it (newton_finish.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "estimation/stages.h"

namespace standin {

/// Weighted so that frames far below this (nearly empty ones) hardly matter: no placement turns on them.
inline constexpr double kSmallFrameMs = 0.3;
/// Of Cauchy's loss: rows that are off by more than a tenth count ever less.
inline constexpr double kLossScale = 0.1;

struct FitProblem {
  std::vector<double> features;      // row by row, terms in each; 0 to 1e300
  std::vector<double> milliseconds;  // of each row; above 0, to 1e300
  std::vector<Stage> stages;         // of each term
  [[nodiscard]] std::size_t rows() const { return milliseconds.size(); }
  [[nodiscard]] std::size_t terms() const { return stages.size(); }
};

struct FitOptions {
  Combination combination = Combination::kSum;
  double tolerance = 1e-11;  // of each coefficient's last step, relative
};

struct FitResult {
  std::vector<double> milliseconds_per_unit;  // >= 0
  std::vector<bool> at_bound;                 // 0 although some row has the term
  /// Of the free terms' relative errors, terms x terms, as of weighted least squares with the loss's last weights; 0 in rows and columns of
  /// terms at 0, infinity where there is none (no more rows than free terms, or dependent columns).
  std::vector<double> relative_covariance;
  std::vector<double> relative_standard_error;  // roots of its diagonal; infinity at 0
  double condition_number = 1.0;                // of the free terms' weighted columns, each scaled to length 1; infinity: dependent
  std::vector<double> weakest_direction;        // of length 1: the mixture of scaled terms that the rows say least about
  double objective = 0.0;                       // half the sum of rho
  bool converged = false;
  std::string stopped;  // how the solver ended
};

/// Deterministic. A maximum has kinks: a fit that ends in one may stop short of the best coefficients by about a thousandth, not converged.
/// Throws Failure(kBadUsage) naming the row for what is not finite or has a wrong sign, or when there is no row or no term.
[[nodiscard]] FitResult fit_robustly(const FitProblem& problem, const FitOptions& options);

/// Rows evenly spread, about `count` of them, so that each term has its share of rows however rare it is; ascending, all if there are
/// fewer.
[[nodiscard]] std::vector<std::size_t> spread_rows(const FitProblem& problem, std::size_t count);

/// Whether Ceres' gradient checker finds the derivatives right at these coefficients, within `relative`, under both losses; a test's hook.
[[nodiscard]] bool gradients_agree(const FitProblem& problem, Combination combination, const std::vector<double>& milliseconds_per_unit,
                                   double relative);

}  // namespace standin
