// What the samples of a part add up to, in one image or at most over many (features.h says what the terms mean).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "estimation/screen_coverage.h"

namespace standin {

// Of a triangle, in pixels, by kind. A larger one costs by its pixels; and of the many triangles of a near object, a bound counts each at
// its nearest: without a limit their edges alone would fill a region's budget (tests/bench/region_bound.md). Masked triangles are leaves,
// many and near, and their pixels cost more: they have the lowest limit.
inline constexpr std::array<double, kPixelKindCount> kMostEdgePixels = {64.0, 64.0, 16.0};

[[nodiscard]] inline double most_edge_pixels(PixelKind kind) {
  return kMostEdgePixels[static_cast<std::size_t>(kind)];
}

/// What a part shows, or may show at most.
struct PartSum {
  double triangles = 0.0;
  double edge_pixels = 0.0;
  double pixels = 0.0;  // generated

  /// No longer than the edges of so many triangles of twice the mesh's slenderness that share so many pixels (Cauchy and Schwarz): of a
  /// large part near the eye, only as much as there is room for in the image. Monotone in all three, so a bound stays one.
  void limit_edges(double slenderness, double most_pixels) {
    edge_pixels = std::min(edge_pixels, 1.3 * slenderness * std::sqrt(triangles * std::min(pixels, most_pixels)));
  }
};

[[nodiscard]] inline PartSum larger(const PartSum& a, const PartSum& b) {
  return {std::max(a.triangles, b.triangles), std::max(a.edge_pixels, b.edge_pixels), std::max(a.pixels, b.pixels)};
}

}  // namespace standin
