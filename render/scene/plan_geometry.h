// Geometry in the plan of a city: x to the east, y to the south, in metres (or in widths of a tile). World space has this y as its z.
#pragma once

#include <vector>

#include "render/base/geometry.h"

namespace standin {

using Path = std::vector<Vec2>;

/// Rings do not repeat their first point; which way round they run is left open.
struct Polygon {
  Path shell;
  std::vector<Path> holes;
};

/// Positive where the ring runs clockwise on a map (y down), as the outer rings of vector tiles do.
[[nodiscard]] inline double signed_area(const Path& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * twice;
}

/// Axis-aligned rectangle; empty until extended.
struct PlanBox {
  Vec2 min{std::numeric_limits<double>::infinity()};
  Vec2 max{-std::numeric_limits<double>::infinity()};

  void extend(const Vec2& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void extend(const Path& path) {
    for (const Vec2& point : path) extend(point);
  }
  [[nodiscard]] Vec2 centre() const { return 0.5 * (min + max); }
  [[nodiscard]] Vec2 size() const { return max - min; }
  [[nodiscard]] bool holds(const PlanBox& box) const {
    return min.x <= box.min.x && min.y <= box.min.y && box.max.x <= max.x && box.max.y <= max.y;
  }
  [[nodiscard]] bool meets(const PlanBox& box) const {
    return min.x <= box.max.x && min.y <= box.max.y && box.min.x <= max.x && box.min.y <= max.y;
  }
};

}  // namespace standin
