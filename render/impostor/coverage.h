// Closed supercover coverage: every texel whose closed square meets a convex polygon (math.md 1.7).
//
// A row's strip meets the polygon in a convex set, whose shadow on the x axis is one interval; the texels that this interval touches are
// the row's. No texel centre is asked, so nothing thin is missed, and a polygon that two layers share along a border marks the same texels
// in both. A slack of a billionth of a texel keeps rounding from turning a touch into a miss.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/impostor/slab_piece.h"

namespace standin {

class ClosedCoverage {
 public:
  ClosedCoverage(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {}

  /// visit(y, first_x, last_x) for each row of texels the piece touches, within the texture.
  template <class Visit>
  void for_each_row(const Piece& piece, const Visit& visit) {
    for_each_row(piece, Vec2(0.0), visit);
  }

  /// The same for the piece with so many texels more to each side, along x and y.
  template <class Visit>
  void for_each_row(const Piece& piece, const Vec2& margin, const Visit& visit) {
    if (piece.count == 0) return;
    margin_ = margin;
    double top = piece.vertices[0].position.y, bottom = top;
    for (std::size_t i = 1; i < piece.count; ++i) {
      top = std::min(top, piece.vertices[i].position.y);
      bottom = std::max(bottom, piece.vertices[i].position.y);
    }
    const Range rows = touched(top - margin.y, bottom + margin.y, height_);
    if (rows.first > rows.last) return;
    spans_.assign(static_cast<std::size_t>(rows.last) - static_cast<std::size_t>(rows.first) + 1, Span{});
    if (rows.first == rows.last && top >= rows.first && bottom <= rows.first + 1.0) {
      for (std::size_t i = 0; i < piece.count; ++i) spans_[0].extend(piece.vertices[i].position.x);
    } else {
      for (std::size_t i = 0; i < piece.count; ++i)
        add_edge(piece.vertices[i].position, piece.vertices[(i + 1) % piece.count].position, rows);
    }
    for (int row = rows.first; row <= rows.last; ++row) {
      const Span& span = spans_[static_cast<std::size_t>(row - rows.first)];
      const Range columns = touched(span.low - margin.x, span.high + margin.x, width_);
      if (columns.first <= columns.last)
        visit(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(columns.first), static_cast<std::uint32_t>(columns.last));
    }
  }

 private:
  static constexpr double kSlack = 1e-9;
  struct Span {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void extend(double x) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  };
  struct Range {
    int first = 0;
    int last = -1;
  };

  /// Cells [i, i+1] of [0, size) that meet the closed interval.
  [[nodiscard]] static Range touched(double low, double high, std::uint32_t size) {
    if (!(low <= high)) return {};
    const double first = std::ceil(low - kSlack) - 1.0, last = std::floor(high + kSlack);
    if (last < 0.0 || first >= size) return {};
    return {static_cast<int>(std::max(first, 0.0)), static_cast<int>(std::min(last, size - 1.0))};
  }

  void add_edge(Vec2 a, Vec2 b, const Range& rows) {
    if (b.y < a.y || (b.y == a.y && b.x < a.x)) std::swap(a, b);  // the same order for both neighbours of an edge
    const int first = static_cast<int>(std::max(std::ceil(a.y - margin_.y - kSlack) - 1.0, static_cast<double>(rows.first)));
    const int last = static_cast<int>(std::min(std::floor(b.y + margin_.y + kSlack), static_cast<double>(rows.last)));
    const double x_per_y = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    for (int row = first; row <= last; ++row) {
      Span& span = spans_[static_cast<std::size_t>(row - rows.first)];
      const double upper = row - margin_.y, lower = row + 1.0 + margin_.y;
      span.extend(upper <= a.y ? a.x : a.x + (std::min(upper, b.y) - a.y) * x_per_y);
      span.extend(lower >= b.y ? b.x : a.x + (std::max(lower, a.y) - a.y) * x_per_y);
    }
  }

  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  Vec2 margin_{0.0};
  std::vector<Span> spans_;
};

}  // namespace standin
