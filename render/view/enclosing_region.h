// The enclosing frustum of a view space region (thesis 5.5.2; math.md 4): a convex region that contains the frustum of every view whose
// position lies in a box and whose direction lies in an interval.
//
// It is the intersection of A, a cone around the box of positions that holds under any roll, and C, up to eight planes for the roll-free
// camera (none near the poles, where that camera turns too fast). A box that misses either is seen by no such view: rejections are
// conservative, acceptances are not. The test subtracts the boxes, so that the cone's apex is the origin and needs no shift, and rejects by
// support functions only: by the planes, by the half-spaces in front, and by the tangent plane of the cone nearest to the box.
#pragma once

#include <vector>

#include "render/view/camera.h"
#include "render/view/direction_interval.h"

namespace standin {

/// Depends on the directions and the camera only; one serves every box (and is shared by threads).
struct DirectionCone {
  Vec3 axis{0.0};
  double half_angle_rad = 0.0;  // >= pi/2: everything
  double cos_half_angle = 1.0;
  double sin_half_angle = 0.0;
  std::vector<Vec3> plane_normals;  // outward, of C and of the half-spaces in front; region is { x : n.x <= support of the box along n }
};

[[nodiscard]] DirectionCone enclosing_cone(const DirectionInterval& interval, const Camera& camera);
/// For a general convex cell on a face (golden vectors): tangents {a0, a1, b0, b1}, frame n, u, v, camera up.
[[nodiscard]] DirectionCone enclosing_cone(const FaceFrame& frame, const std::array<double, 4>& tangents, double tan_half_x,
                                           double tan_half_y, const Vec3& up);

/// False only if no view with position in `positions` and direction in the cone's interval sees any point of `box`.
[[nodiscard]] bool may_see(const DirectionCone& cone, const Box& positions, const Box& box);
[[nodiscard]] bool contains(const DirectionCone& cone, const Box& positions, const Vec3& point);

}  // namespace standin
