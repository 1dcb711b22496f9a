// Views and the camera that looks along them.
//
// A view is a position and a direction; the field of view, the resolution and the up vector are fixed per job and roll is excluded
// (thesis 5.3): right = normalise(direction x up). At the poles, where that vanishes, right is the limit reached along -z of the world.
#pragma once

#include <cmath>

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

/// A view's frustum for boxes: every plane through the eye, of those that could separate it from an axis-aligned box, that has the frustum
/// on its inner side. These are its five own planes (four sides, and the one through the eye), the box's axes, and the planes that hold an
/// edge of each (separating axis theorem); with all of them the test is exact, with the five alone boxes beside an edge pass that no point
/// of the frustum is in.
struct Frustum {
  std::array<Plane, 35> planes;  // 5 + 2 * 3 + 2 * 3 * 4 at most
  std::size_t count = 0;
};
[[nodiscard]] Frustum frustum_of(const View& view, const Camera& camera);

/// False only where the box lies outside (by more than rounding).
[[nodiscard]] inline bool may_intersect(const Frustum& frustum, const Box& box) {
  for (std::size_t i = 0; i < frustum.count; ++i) {
    const Plane& plane = frustum.planes[i];
    if (-box.support(-plane.normal) > plane.offset + 1e-12 * (1.0 + std::abs(plane.offset))) return false;
  }
  return true;
}

}  // namespace standin
