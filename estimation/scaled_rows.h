// A fit's rows scaled to unknowns of order one, and the loss on their residuals; internal to the robust fit.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "estimation/robust_fit.h"

namespace standin {

/// rho(r^2) of a residual r, its derivative by r^2, and the curvature rho' + 2 r^2 rho'' along r (half the second derivative by r).
struct Loss {
  enum class Kind { kConvex, kRedescending };
  struct Value {
    double rho, slope, curvature;
  };
  Kind kind = Kind::kRedescending;
  double scale = kLossScale;

  [[nodiscard]] Value at(double residual) const {
    const double b = scale * scale, t = residual * residual / b;
    if (kind == Kind::kRedescending) return {b * std::log1p(t), 1.0 / (1.0 + t), (1.0 - t) / ((1.0 + t) * (1.0 + t))};
    const double root = std::sqrt(1.0 + t);  // 2 b (root - 1), written without cancellation
    return {2.0 * b * t / (1.0 + root), 1.0 / root, 1.0 / (root * root * root)};
  }
};

/// Residual of row i over scaled coefficients u: prediction(u) - target(i); milliseconds per unit = u * unit.
class ScaledRows {
 public:
  ScaledRows(const FitProblem& problem, Combination combination);
  [[nodiscard]] ScaledRows subset(const std::vector<std::size_t>& rows) const;

  [[nodiscard]] std::size_t rows() const { return targets_.size(); }
  [[nodiscard]] std::size_t terms() const { return units_.size(); }
  [[nodiscard]] double target(std::size_t row) const { return targets_[row]; }
  /// Milliseconds per unit at which a term alone would explain the rows (root mean square); 0 for a term that no row has.
  [[nodiscard]] double unit(std::size_t term) const { return units_[term]; }
  [[nodiscard]] const double* row(std::size_t row) const { return x_.data() + row * terms(); }

  [[nodiscard]] double residual(std::size_t row, const double* u) const;
  /// With the residual's derivative by u: the row, 0 where its stage is hidden by the slower one.
  double residual(std::size_t row, const double* u, double* derivative) const;
  [[nodiscard]] double objective(const Loss& loss, const double* u) const;
  /// A point from which neither stage hides the other throughout.
  [[nodiscard]] std::vector<double> start() const;

 private:
  ScaledRows() = default;
  struct Parts {
    double shared, geometry, fill;
  };
  [[nodiscard]] Parts parts(std::size_t row, const double* u) const;

  Combination combination_ = Combination::kSum;
  std::vector<Stage> stages_;
  std::vector<double> units_, x_, targets_;
};

}  // namespace standin
