// The robust, non-negative fit behind calibration (thesis 5.8.1 uses plain least squares), apart so that only one file includes Ceres.
#pragma once

#include <string>
#include <vector>

#include "estimation/calibrate.h"

namespace standin {

/// Which terms take part; the others stay 0.
using TermSet = std::array<bool, kTermCount>;

struct CostFit {
  std::array<double, kTermCount> milliseconds_per_unit{};
  double pixel_cap_ms = 0.0;  // infinity: none
  std::string stopped;        // how the solver ended
};

/// Weighted so that frames far below this (nearly empty ones) hardly matter: no placement turns on them.
inline constexpr double kSmallFrameMs = 0.3;

/// Least robust relative residuals over `rows` (indices into frames), each coefficient >= 0. The pixel cap is fitted along from
/// `first_pixel_cap_ms` > 0, or left out where that is infinity.
[[nodiscard]] CostFit fit_costs(const std::vector<TimedFrame>& frames, const std::vector<std::size_t>& rows, const TermSet& terms,
                                double first_pixel_cap_ms);

}  // namespace standin
