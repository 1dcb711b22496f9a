#include "render/view/view_cell.h"

#include <cmath>

namespace standin {
namespace {

constexpr double kPoleSine = 1e-9;

// A tightened shaft touches the cells it serves: without this share of the coordinates rounding would put their corners outside.
constexpr double kRoundingShare = 1e-12;

bool inside(const Shaft& shaft, const Vec3& position) {
  const Vec3 from_apex = position - shaft.apex;
  const double along = glm::dot(from_apex, shaft.axis);
  const double slack = kRoundingShare * glm::length(from_apex);
  return along >= shaft.min_distance_m - slack && std::abs(glm::dot(from_apex, shaft.right)) <= shaft.tan_half.x * along + slack &&
         std::abs(glm::dot(from_apex, shaft.up)) <= shaft.tan_half.y * along + slack;
}

// A shaft is convex, so the corners decide.
bool inside(const Shaft& shaft, const Box& positions) {
  for (int i = 0; i < 8; ++i)
    if (!inside(shaft, positions.corner(i))) return false;
  return !positions.empty();
}

bool inside(const Box& cell, const Box& positions) {
  return !positions.empty() && cell.contains(positions.min) && cell.contains(positions.max);
}

}  // namespace

Shaft shaft_frame(const Vec3& apex, const Vec3& axis) {
  const bool pole = std::hypot(axis.x, axis.z) <= kPoleSine;
  Shaft shaft;
  shaft.apex = apex;
  shaft.axis = axis;
  shaft.right = glm::normalize(glm::cross(pole ? Vec3(0.0, 0.0, -1.0) : Vec3(0.0, 1.0, 0.0), axis));
  shaft.up = glm::cross(axis, shaft.right);
  return shaft;
}

bool encloses(const ViewCell& cell, const Box& positions) {
  return std::visit([&](const auto& shape) { return inside(shape, positions); }, cell);
}

bool encloses(const ViewCell& cell, const Vec3& position) {
  return encloses(cell, Box{position, position});
}

}  // namespace standin
