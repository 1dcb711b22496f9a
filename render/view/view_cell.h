// View cells: the 3D region an impostor is valid for (thesis 1.3).
//
// A shaft is the square pyramid of `tan_half` about an axis that starts at the apex (the cluster's centre) and points to the viewer, cut by
// the plane at `min_distance` along it and open at the far end. A box is axis-aligned in the world.
#pragma once

#include <variant>

#include "render/base/geometry.h"

namespace standin {

struct Shaft {
  Vec3 apex{0.0};
  Vec3 axis{0.0, 0.0, 1.0};  // axis, right, up: orthonormal, right = up x axis
  Vec3 right{1.0, 0.0, 0.0};
  Vec3 up{0.0, 1.0, 0.0};
  Vec2 tan_half{0.0};           // along right and up
  double min_distance_m = 0.0;  // along the axis
};

using ViewCell = std::variant<Shaft, Box>;

/// An orthonormal frame (axis, right, up) about a unit axis; up is as near to world y as it can be (near the poles: to world -z).
[[nodiscard]] Shaft shaft_frame(const Vec3& apex, const Vec3& axis);
/// Whether every point of `positions` lies in the view cell.
[[nodiscard]] bool encloses(const ViewCell& cell, const Box& positions);
[[nodiscard]] bool encloses(const ViewCell& cell, const Vec3& position);

}  // namespace standin
