// How large an error of a surface may be, seen from afar by a camera, to move nothing by more than so many pixels (corner growth: math.md
// of centre pixels in camera.h).
//
// Two points e apart, neither nearer to the eye than d, lie within 2 asin(e / 2d) of each other in angle; and an angle is largest in the
// image in its corner, where it grows by 1 / cos^2 of the half diagonal.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/view/camera.h"

namespace standin {

/// Metres of error per metre of distance that project to `error_px`.
[[nodiscard]] inline double error_m_per_m(const Camera& camera, double error_px) {
  const double cosine = std::cos(camera.half_diagonal_rad());
  const double angle_rad = error_px * cosine * cosine / camera.focal_px();
  return 2.0 * std::sin(0.5 * std::min(angle_rad, std::numbers::pi));
}

/// How many of its radii away a sphere's disc has the area of the image.
[[nodiscard]] inline double whole_image_distance(const Camera& camera) {
  return camera.focal_px() * std::sqrt(std::numbers::pi / (static_cast<double>(camera.width) * camera.height));
}

}  // namespace standin
