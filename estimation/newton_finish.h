// The end of the robust fit: Newton's method with bounds, each step a non-negative least-squares problem solved by QR; internal to the fit.
//
// Gauss-Newton under a redescending loss converges only linearly, and projected steps stall where bounds are active; both leave the eighth
// digit open. Here each step minimises the exact quadratic model over u >= 0 (Lawson and Hanson 1974, chapter 23). Rows of positive
// curvature go through a QR decomposition, batch by batch, so that memory does not grow with rows; the others (beyond the loss's scale)
// correct it in the coordinates that the QR has whitened, so that normal equations are formed nowhere. Where that model has no minimum,
// rows are weighted by rho' instead, which never raises the objective (majorisation: rho is concave in r^2).
#pragma once

#include <string>
#include <vector>

#include "estimation/scaled_rows.h"

namespace standin {

struct NewtonFinish {
  std::vector<double> u;
  bool converged = false;
  std::string stopped;
};

/// From `u` >= 0, which it never makes worse, to a relative step of `tolerance` in each coefficient, or to rounding.
[[nodiscard]] NewtonFinish newton_finish(const ScaledRows& rows, const Loss& loss, std::vector<double> u, double tolerance);

/// What the rows say about the free terms at `u`, fills the diagnostics of `result`.
void diagnose(const ScaledRows& rows, const Loss& loss, const std::vector<double>& u, FitResult& result);

}  // namespace standin
