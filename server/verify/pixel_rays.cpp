#include "server/verify/pixel_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace standin {

PixelRays::PixelRays(const View& view, const Camera& camera)
    : view_(view),
      camera_(camera),
      tan_half_(camera.tan_half_x(), camera.tan_half_y()),
      world_from_eye_(world_from_eye_rotation(view.direction)) {}

Vec3 PixelRays::direction(int x, int y) const {
  const double right = tan_half_.x * (2.0 * (x + 0.5) / camera_.width - 1.0);
  const double up = tan_half_.y * (1.0 - 2.0 * (y + 0.5) / camera_.height);
  return glm::normalize(world_from_eye_ * Vec3(right, up, -1.0));
}

PixelRay PixelRays::ray(int x, int y) const {
  return {view_.position, direction(x, y), direction(x + 1, y), direction(x, y + 1)};
}

PixelWindow PixelRays::window_of(const Box& box) const {
  Vec2 low(std::numeric_limits<double>::infinity());
  Vec2 high = -low;
  for (int i = 0; i < 8; ++i) {
    const Vec3 eye = (box.corner(i) - view_.position) * world_from_eye_;
    if (!(eye.z < 0.0)) return {0, 0, camera_.width, camera_.height};
    const Vec2 ndc(eye.x / (-eye.z * tan_half_.x), -eye.y / (-eye.z * tan_half_.y));
    low = glm::min(low, ndc);
    high = glm::max(high, ndc);
  }
  const auto pixel = [](double ndc, int size, int margin) {
    return static_cast<int>(std::clamp(std::floor(0.5 * (ndc + 1.0) * size) + margin, 0.0, static_cast<double>(size)));
  };
  return {pixel(low.x, camera_.width, -kDiscRadius_px), pixel(low.y, camera_.height, -kDiscRadius_px),
          pixel(high.x, camera_.width, kDiscRadius_px + 1), pixel(high.y, camera_.height, kDiscRadius_px + 1)};
}

}  // namespace standin
