// The only file that includes Ceres.
#include "estimation/robust_fit.h"

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>

#include <algorithm>
#include <cmath>

#include "estimation/newton_finish.h"
#include "estimation/scaled_rows.h"
#include "render/base/error.h"

namespace standin {
namespace {

constexpr std::size_t kBasinRows = 1500;
constexpr double kConvexScale = 0.2;
constexpr double kGreatest = 1e300;  // products with weights stay finite

/// All rows' residuals over the scaled coefficients, the loss inside: r' = sign(r) sqrt(rho(r^2)), which is smooth, so that half the sum of
/// squares is the robust objective. One block instead of one a row: Ceres' book-keeping would cost more than the sums.
class RobustResiduals : public ceres::CostFunction {
 public:
  RobustResiduals(const ScaledRows& rows, const Loss& loss) : rows_(rows), loss_(loss) {
    set_num_residuals(static_cast<int>(rows.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(rows.terms()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double* u = parameters[0];
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    for (std::size_t i = 0; i < rows_.rows(); ++i) {
      double* derivative = jacobian != nullptr ? jacobian + i * rows_.terms() : nullptr;
      const double r = derivative != nullptr ? rows_.residual(i, u, derivative) : rows_.residual(i, u);
      const Loss::Value value = loss_.at(r);
      const bool tiny = !(value.rho > 0.0);  // r^2 has vanished: the loss is r^2
      residuals[i] = tiny ? r : std::copysign(std::sqrt(value.rho), r);
      if (derivative == nullptr || tiny) continue;
      const double inner = value.slope * r / residuals[i];
      for (std::size_t j = 0; j < rows_.terms(); ++j) derivative[j] *= inner;
    }
    return true;
  }

 private:
  const ScaledRows& rows_;
  Loss loss_;
};

/// Least squares within bounds, roughly: Newton's method ends what this begins.
void solve(const ScaledRows& rows, const Loss& loss, double tolerance, std::vector<double>& u) {
  ceres::Problem problem;
  problem.AddResidualBlock(new RobustResiduals(rows, loss), nullptr, u.data());
  for (std::size_t j = 0; j < u.size(); ++j) problem.SetParameterLowerBound(u.data(), static_cast<int>(j), 0.0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = tolerance;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw Failure(ErrorWord::kInternal, "the time model's fit failed: " + summary.message);
}

[[noreturn]] void refuse(std::size_t row, const std::string& what, double value) {
  throw Failure(ErrorWord::kBadUsage, "row " + std::to_string(row) + ": " + what + " is " + std::to_string(value));
}

void check(const FitProblem& problem) {
  if (problem.rows() == 0 || problem.terms() == 0)
    throw Failure(ErrorWord::kBadUsage,
                  "a fit needs rows and terms; there are " + std::to_string(problem.rows()) + " and " + std::to_string(problem.terms()));
  if (problem.features.size() != problem.rows() * problem.terms())
    throw Failure(ErrorWord::kInternal, "a fit of " + std::to_string(problem.rows()) + " rows and " + std::to_string(problem.terms()) +
                                            " terms has " + std::to_string(problem.features.size()) + " features");
  for (std::size_t i = 0; i < problem.rows(); ++i) {
    if (!(problem.milliseconds[i] > 0.0 && problem.milliseconds[i] <= kGreatest))
      refuse(i, "its time in milliseconds, which must be positive and finite,", problem.milliseconds[i]);
    for (std::size_t j = 0; j < problem.terms(); ++j)
      if (const double value = problem.features[i * problem.terms() + j]; !(value >= 0.0 && value <= kGreatest))
        refuse(i, "feature " + std::to_string(j) + ", which must be finite and >= 0,", value);
  }
}

std::vector<double> basin(const FitProblem& problem, const ScaledRows& all) {
  std::vector<double> u = all.start();
  const ScaledRows few = all.subset(spread_rows(problem, kBasinRows));
  solve(few, {Loss::Kind::kConvex, kConvexScale}, 1e-4, u);
  solve(few, {Loss::Kind::kRedescending, kLossScale}, 1e-5, u);
  return u;
}

}  // namespace

FitResult fit_robustly(const FitProblem& problem, const FitOptions& options) {
  check(problem);
  const ScaledRows rows(problem, options.combination);
  const Loss loss;
  const NewtonFinish finish = newton_finish(rows, loss, basin(problem, rows), options.tolerance);
  FitResult result;
  result.converged = finish.converged;
  result.stopped = finish.stopped;
  result.objective = rows.objective(loss, finish.u.data());
  for (std::size_t j = 0; j < problem.terms(); ++j) {
    result.milliseconds_per_unit.push_back(finish.u[j] * rows.unit(j));
    result.at_bound.push_back(rows.unit(j) > 0.0 && !(finish.u[j] > 0.0));
  }
  diagnose(rows, loss, finish.u, result);
  return result;
}

std::vector<std::size_t> spread_rows(const FitProblem& problem, std::size_t count) {
  std::vector<bool> chosen(problem.rows(), problem.rows() <= count);
  const std::size_t share = count / (problem.terms() + 1);
  const auto spread = [&](const std::vector<std::size_t>& rows) {
    for (std::size_t k = 0; k < std::min(share, rows.size()); ++k) chosen[rows[k * rows.size() / std::min(share, rows.size())]] = true;
  };
  std::vector<std::size_t> rows(problem.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  spread(rows);
  for (std::size_t j = 0; j < problem.terms(); ++j) {
    rows.clear();
    for (std::size_t i = 0; i < problem.rows(); ++i)
      if (problem.features[i * problem.terms() + j] > 0.0) rows.push_back(i);
    spread(rows);
  }
  rows.clear();
  for (std::size_t i = 0; i < problem.rows(); ++i)
    if (chosen[i]) rows.push_back(i);
  return rows;
}

bool gradients_agree(const FitProblem& problem, Combination combination, const std::vector<double>& milliseconds_per_unit,
                     double relative) {
  const ScaledRows rows(problem, combination);
  std::vector<double> u(rows.terms(), 0.0);
  for (std::size_t j = 0; j < u.size(); ++j)
    if (rows.unit(j) > 0.0) u[j] = milliseconds_per_unit[j] / rows.unit(j);
  ceres::NumericDiffOptions steps;
  steps.ridders_relative_initial_step_size = 1e-3;  // well within the loss's scale
  bool agree = true;
  for (const Loss loss : {Loss{Loss::Kind::kConvex, kConvexScale}, Loss{Loss::Kind::kRedescending, kLossScale}}) {
    const RobustResiduals residuals(rows, loss);
    const std::vector<const ceres::Manifold*>* const no_manifolds = nullptr;
    const ceres::GradientChecker checker(&residuals, no_manifolds, steps);
    const double* block = u.data();
    // Its detailed results are Eigen matrices, which a sanitized build must not free for a library that is not: only the verdict is asked.
    agree = checker.Probe(&block, relative, nullptr) && agree;
  }
  return agree;
}

}  // namespace standin
