#include "render/view/camera.h"

#include <cmath>

namespace standin {
namespace {

// Below this sine of the angle to the up vector a direction counts as a pole: there right = direction x up is rounding noise.
constexpr double kPoleSine = 1e-12;

Vec3 right_of(const Vec3& direction) {
  const double sine = std::hypot(direction.x, direction.z);
  if (sine <= kPoleSine) return {1.0, 0.0, 0.0};
  return {-direction.z / sine, 0.0, direction.x / sine};  // direction x (0, 1, 0)
}

}  // namespace

double Camera::tan_half_y() const {
  return std::tan(0.5 * fov_y_rad);
}

double Camera::tan_half_x() const {
  return tan_half_y() * width / height;
}

double Camera::half_diagonal_rad() const {
  return std::atan(std::hypot(tan_half_x(), tan_half_y()));
}

double Camera::pixel_angle_rad() const {
  return 2.0 * std::atan(tan_half_y() / height);
}

double Camera::focal_px() const {
  return height / (2.0 * tan_half_y());
}

Mat3 world_from_eye_rotation(const Vec3& direction) {
  const Vec3 right = right_of(direction);
  return {right, glm::cross(right, direction), -direction};
}

Mat4 eye_from_world(const View& view) {
  const Mat3 eye_from_world_rotation = glm::transpose(world_from_eye_rotation(view.direction));
  Mat4 result(eye_from_world_rotation);
  result[3] = Vec4(-(eye_from_world_rotation * view.position), 1.0);
  return result;
}

Mat4 clip_from_eye(const Camera& camera) {
  Mat4 result(0.0);
  result[0][0] = 1.0 / camera.tan_half_x();
  result[1][1] = 1.0 / camera.tan_half_y();
  result[2][2] = -1.0;
  result[2][3] = -1.0;
  result[3][2] = -2.0 * camera.near_m;
  return result;
}

Frustum frustum_of(const View& view, const Camera& camera) {
  const Mat3 frame = world_from_eye_rotation(view.direction);
  const Vec3 x_border = camera.tan_half_x() * frame[0], y_border = camera.tan_half_y() * frame[1];
  const std::array<Vec3, 4> edges = {
      glm::normalize(view.direction + x_border + y_border), glm::normalize(view.direction + x_border - y_border),
      glm::normalize(view.direction - x_border + y_border), glm::normalize(view.direction - x_border - y_border)};
  Frustum frustum;
  const auto add = [&](const Vec3& outward) {
    const double length = glm::length(outward);
    if (!(length > 1e-9)) return;
    const Vec3 normal = outward / length;
    for (const Vec3& edge : edges)
      if (glm::dot(normal, edge) > 1e-12) return;
    frustum.planes[frustum.count++] = {normal, glm::dot(normal, view.position)};
  };
  for (const double sign : {1.0, -1.0}) {
    add(sign * frame[0] - camera.tan_half_x() * view.direction);
    add(sign * frame[1] - camera.tan_half_y() * view.direction);
  }
  add(-view.direction);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    for (const double sign : {1.0, -1.0}) {
      add(sign * axis);
      for (const Vec3& edge : edges) add(sign * glm::cross(axis, edge));
    }
  return frustum;
}

}  // namespace standin
