// The only file that includes Ceres.
#include "estimation/robust_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"

namespace standin {
namespace {

using Coefficients = std::array<double, kTermCount>;

constexpr double kNeverReached_ms = std::numeric_limits<double>::max();  // Ceres takes no infinity

/// (predicted - measured) / (measured + small frame) over scaled coefficients u: milliseconds per unit = u * unit.
struct FrameResidual {
  std::array<double, kTermCount> fixed{};  // scaled features, pixel terms apart
  std::array<double, kTermCount> pixels{};
  double milliseconds;
  double weight;

  FrameResidual(const TimedFrame& frame, const Coefficients& unit)
      : milliseconds(frame.milliseconds), weight(1.0 / (frame.milliseconds + kSmallFrameMs)) {
    for (std::size_t i = 0; i < kTermCount; ++i)
      (is_pixel_term(static_cast<Term>(i)) ? pixels : fixed)[i] = frame.features.value[i] * unit[i];
  }

  template <typename T>
  bool operator()(const T* u, const T* pixel_cap_ms, T* residual) const {
    T fixed_ms(0.0);
    T pixel_ms(0.0);
    for (std::size_t i = 0; i < kTermCount; ++i) {
      fixed_ms += fixed[i] * u[i];
      pixel_ms += pixels[i] * u[i];
    }
    *residual = (fixed_ms + (pixel_ms < *pixel_cap_ms ? pixel_ms : *pixel_cap_ms) - milliseconds) * weight;
    return true;
  }
};

/// Milliseconds per unit at which a term alone would explain the frames (root mean square): makes every unknown of order one.
Coefficients column_units(const std::vector<TimedFrame>& frames, const std::vector<std::size_t>& rows) {
  Coefficients unit{};
  for (std::size_t i = 0; i < kTermCount; ++i) {
    double sum = 0.0;
    for (const std::size_t row : rows) {
      const double relative = frames[row].features.value[i] / (frames[row].milliseconds + kSmallFrameMs);
      sum += relative * relative;
    }
    unit[i] = sum > 0.0 ? std::sqrt(static_cast<double>(rows.size()) / sum) : 0.0;
  }
  return unit;
}

/// One least-squares problem over scaled coefficients `u` and the cap, both changed in place.
std::string solve(const std::vector<TimedFrame>& frames, const std::vector<std::size_t>& rows, const TermSet& terms,
                  const Coefficients& unit, double tolerance, ceres::LossFunction* loss, Coefficients& u, double& pixel_cap_ms) {
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (const std::size_t row : rows)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<FrameResidual, 1, static_cast<int>(kTermCount), 1>(new FrameResidual(frames[row], unit)), loss,
        u.data(), &pixel_cap_ms);
  std::vector<int> held;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    problem.SetParameterLowerBound(u.data(), static_cast<int>(i), 0.0);
    if (!terms[i]) held.push_back(static_cast<int>(i));
  }
  if (!held.empty()) problem.SetManifold(u.data(), new ceres::SubsetManifold(static_cast<int>(kTermCount), held));
  if (pixel_cap_ms == kNeverReached_ms)
    problem.SetParameterBlockConstant(&pixel_cap_ms);
  else
    problem.SetParameterLowerBound(&pixel_cap_ms, 0, 0.0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = tolerance;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw Failure(ErrorWord::kInternal, "the time model's fit failed: " + summary.message);
  return std::string(ceres::TerminationTypeToString(summary.termination_type)) + ": " + summary.message;
}

}  // namespace

CostFit fit_costs(const std::vector<TimedFrame>& frames, const std::vector<std::size_t>& rows, const TermSet& terms,
                  double first_pixel_cap_ms) {
  const Coefficients unit = column_units(frames, rows);
  Coefficients u{};
  for (std::size_t i = 0; i < kTermCount; ++i) u[i] = terms[i] ? 1.0 / static_cast<double>(kTermCount) : 0.0;
  CostFit fit;
  fit.pixel_cap_ms = std::min(first_pixel_cap_ms, kNeverReached_ms);
  // The first loss is convex where no cap bends the model, so the second, which all but ignores outliers, starts in the right basin.
  ceres::SoftLOneLoss convex(0.2);
  ceres::CauchyLoss redescending(0.1);
  solve(frames, rows, terms, unit, 1e-4, &convex, u, fit.pixel_cap_ms);
  fit.stopped = solve(frames, rows, terms, unit, 1e-14, &redescending, u, fit.pixel_cap_ms);
  for (std::size_t i = 0; i < kTermCount; ++i) fit.milliseconds_per_unit[i] = u[i] * unit[i];
  if (fit.pixel_cap_ms == kNeverReached_ms) fit.pixel_cap_ms = std::numeric_limits<double>::infinity();
  return fit;
}

}  // namespace standin
