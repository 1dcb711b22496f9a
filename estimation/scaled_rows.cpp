#include "estimation/scaled_rows.h"

#include <algorithm>
#include <array>

namespace standin {

ScaledRows::ScaledRows(const FitProblem& problem, Combination combination) : combination_(combination), stages_(problem.stages) {
  const std::size_t count = problem.rows(), n = problem.terms();
  units_.assign(n, 0.0);
  x_.resize(count * n);
  targets_.resize(count);
  // The greatest entry goes out first: squares of what is left neither overflow nor vanish.
  std::vector<double> greatest(n, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double weight = 1.0 / (problem.milliseconds[i] + kSmallFrameMs);
    targets_[i] = problem.milliseconds[i] * weight;
    for (std::size_t j = 0; j < n; ++j) {
      x_[i * n + j] = problem.features[i * n + j] * weight;
      greatest[j] = std::max(greatest[j], x_[i * n + j]);
    }
  }
  std::vector<double> sums(n, 0.0);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (const double share = greatest[j] > 0.0 ? x_[i * n + j] / greatest[j] : 0.0; share > 0.0) sums[j] += share * share;
  for (std::size_t j = 0; j < n; ++j)
    if (const double unit = std::sqrt(static_cast<double>(count) / sums[j]) / greatest[j]; std::isfinite(unit)) units_[j] = unit;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < n; ++j) x_[i * n + j] *= units_[j];
}

ScaledRows ScaledRows::subset(const std::vector<std::size_t>& rows) const {
  ScaledRows some;
  some.combination_ = combination_;
  some.stages_ = stages_;
  some.units_ = units_;
  for (const std::size_t i : rows) {
    some.targets_.push_back(targets_[i]);
    some.x_.insert(some.x_.end(), row(i), row(i) + terms());
  }
  return some;
}

ScaledRows::Parts ScaledRows::parts(std::size_t i, const double* u) const {
  std::array<double, 3> sums{};
  const double* x = row(i);
  for (std::size_t j = 0; j < terms(); ++j) sums[static_cast<std::size_t>(stages_[j])] += x[j] * u[j];
  return {sums[0], sums[1], sums[2]};
}

double ScaledRows::residual(std::size_t i, const double* u) const {
  const Parts part = parts(i, u);
  const double overlapping = combination_ == Combination::kSum ? part.geometry + part.fill : std::max(part.geometry, part.fill);
  return part.shared + overlapping - targets_[i];
}

double ScaledRows::residual(std::size_t i, const double* u, double* derivative) const {
  const double* x = row(i);
  std::copy(x, x + terms(), derivative);
  if (combination_ == Combination::kMax) {
    const Parts part = parts(i, u);
    const Stage hidden = part.geometry < part.fill ? Stage::kGeometry : Stage::kFill;
    for (std::size_t j = 0; j < terms(); ++j)
      if (stages_[j] == hidden) derivative[j] = 0.0;
  }
  return residual(i, u);
}

double ScaledRows::objective(const Loss& loss, const double* u) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows(); ++i) sum += loss.at(residual(i, u)).rho;
  return 0.5 * sum;
}

std::vector<double> ScaledRows::start() const {
  std::array<double, 3> of_stage{};
  for (std::size_t j = 0; j < terms(); ++j)
    if (units_[j] > 0.0) of_stage[static_cast<std::size_t>(stages_[j])] += 1.0;
  std::vector<double> u(terms(), 0.0);
  for (std::size_t j = 0; j < terms(); ++j)
    if (units_[j] > 0.0) u[j] = 0.5 / of_stage[static_cast<std::size_t>(stages_[j])];
  return u;
}

}  // namespace standin
