// Vectors, matrices and boxes.
//
// World space is right-handed, y up, in metres, in double precision; matrices are column major and named
// target_from_source (world_from_object). Angles are radians. GLM's default constructors leave garbage: always initialise.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>
#include <limits>

namespace standin {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;
using Mat3 = glm::dmat3;
using Mat4 = glm::dmat4;

/// Axis-aligned closed box; empty (min > max) until extended.
struct Box {
  Vec3 min{std::numeric_limits<double>::infinity()};
  Vec3 max{-std::numeric_limits<double>::infinity()};

  void extend(const Vec3& point) {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  void extend(const Box& box) {
    min = glm::min(min, box.min);
    max = glm::max(max, box.max);
  }
  [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  [[nodiscard]] Vec3 centre() const { return 0.5 * (min + max); }
  [[nodiscard]] Vec3 size() const { return max - min; }
  [[nodiscard]] double diagonal() const { return empty() ? 0.0 : glm::length(size()); }
  [[nodiscard]] bool contains(const Vec3& p) const {
    return min.x <= p.x && p.x <= max.x && min.y <= p.y && p.y <= max.y && min.z <= p.z && p.z <= max.z;
  }
  /// Corner `i` in 0..7; bit 0, 1, 2 of `i` choose max in x, y, z.
  [[nodiscard]] Vec3 corner(int i) const { return {(i & 1) ? max.x : min.x, (i & 2) ? max.y : min.y, (i & 4) ? max.z : min.z}; }
  /// max of dot(n, x) over the box.
  [[nodiscard]] double support(const Vec3& n) const {
    return n.x * (n.x > 0 ? max.x : min.x) + n.y * (n.y > 0 ? max.y : min.y) + n.z * (n.z > 0 ? max.z : min.z);
  }
  friend bool operator==(const Box& a, const Box& b) { return a.min == b.min && a.max == b.max; }
};

[[nodiscard]] inline Box intersection(const Box& a, const Box& b) {
  return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

/// Least distance between points of two boxes in metres; 0 where they touch.
[[nodiscard]] inline double distance(const Box& a, const Box& b) {
  return glm::length(glm::max(glm::max(a.min - b.max, b.min - a.max), Vec3(0.0)));
}

[[nodiscard]] inline double distance(const Vec3& p, const Box& b) {
  return distance(Box{p, p}, b);
}

/// Bounds of the transformed box.
[[nodiscard]] inline Box transformed(const Mat4& target_from_source, const Box& box) {
  Box result;
  if (box.empty()) return result;
  for (int i = 0; i < 8; ++i) result.extend(Vec3(target_from_source * Vec4(box.corner(i), 1.0)));
  return result;
}

}  // namespace standin
