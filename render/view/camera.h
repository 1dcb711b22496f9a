// Views and the camera that looks along them.
//
// A view is a position and a direction; the field of view, the resolution and the up vector are fixed per job and roll is excluded
// (thesis 5.3): right = normalise(direction x up). At the poles, where that vanishes, right is the limit reached along -z of the world.
#pragma once

#include "render/base/geometry.h"

namespace standin {

struct View {
  Vec3 position{0.0};
  Vec3 direction{0.0, 0.0, -1.0};  // unit length
};

struct Camera {
  double fov_y_rad = 0.78539816339744830962;  // (0, 150 degrees]
  int width = 512;                            // pixels
  int height = 512;
  double near_m = 0.1;

  [[nodiscard]] double tan_half_y() const;
  [[nodiscard]] double tan_half_x() const;
  /// Angle between the axis and a corner ray: atan(hypot(tan_half_x, tan_half_y)).
  [[nodiscard]] double half_diagonal_rad() const;
  /// Angle of the image's centre pixel (math.md 1.1), radians.
  [[nodiscard]] double pixel_angle_rad() const;
  /// Pixels per unit of tangent: height / (2 tan_half_y).
  [[nodiscard]] double focal_px() const;
};

/// Columns: right, up, -direction (an orthonormal, right-handed frame; eye space looks along -z).
[[nodiscard]] Mat3 world_from_eye_rotation(const Vec3& direction);
/// Rigid transform into eye space; subtract a local origin from the position yourself where float follows.
[[nodiscard]] Mat4 eye_from_world(const View& view);
/// OpenGL clip space, infinite far plane.
[[nodiscard]] Mat4 clip_from_eye(const Camera& camera);

/// Half-space { x : dot(normal, x) <= offset }.
struct Plane {
  Vec3 normal{0.0};
  double offset = 0.0;
};

/// The four side planes of a single view's frustum and the plane through the eye (normals outward).
[[nodiscard]] std::array<Plane, 5> frustum_planes(const View& view, const Camera& camera);

/// False only where the box lies wholly outside one plane (conservative).
[[nodiscard]] inline bool may_intersect(const std::array<Plane, 5>& planes, const Box& box) {
  for (const auto& plane : planes)
    if (-box.support(-plane.normal) > plane.offset) return false;
  return true;
}

}  // namespace standin
