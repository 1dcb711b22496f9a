// A camera whose pixels are easy to reckon with: 90 degrees over 16 x 16 pixels, at the origin along -z. At distance 8 m a pixel is 1 m
// wide, and (x, y) lies at pixel column x + 8, row 8 - y.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <numeric>

#include "render/device/renderer.h"
#include "tests/support/scene_builder.h"

namespace standin::test {

using Rgba = std::array<int, 4>;
inline constexpr Rgba kOpaqueWhite{255, 255, 255, 255};

inline Rgba pixel(const Texture& image, int x, int y) {
  const auto* texel = &image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)];
  return {texel[0], texel[1], texel[2], texel[3]};
}

/// Background pixels have alpha 0.
inline bool drawn(const Texture& image, int x, int y) {
  return pixel(image, x, y)[3] == 255;
}

inline int count_drawn(const Texture& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) count += drawn(image, x, y) ? 1 : 0;
  return count;
}

inline std::size_t count_different_pixels(const Texture& a, const Texture& b) {
  std::size_t count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) count += pixel(a, x, y) != pixel(b, x, y) ? 1 : 0;
  return count;
}

inline Camera small_camera() {
  return {.fov_y_rad = std::numbers::pi / 2.0, .width = 16, .height = 16, .near_m = 0.1};
}

inline DrawList everything(const Scene& scene) {
  DrawList list;
  list.objects.resize(scene.objects.size());
  std::iota(list.objects.begin(), list.objects.end(), 0U);
  return list;
}

inline Material unlit(const glm::vec4& colour) {
  Material material;
  material.base_colour = colour;
  material.unlit = true;
  return material;
}

inline Mat4 translation(const Vec3& offset) {
  Mat4 matrix(1.0);
  matrix[3] = Vec4(offset, 1.0);
  return matrix;
}

class DeviceTest : public testing::Test {
 protected:
  /// One frame of `scene`, all objects.
  Texture draw(const Scene& scene, const View& view = {}, const Camera& camera = small_camera()) {
    Renderer renderer(*context, scene, camera);
    counts = renderer.draw(view, everything(scene));
    return renderer.read_pixels();
  }

  std::unique_ptr<Context> context = make_context(DeviceKind::kOsMesa, 16, 16);
  FrameCounts counts;
};

}  // namespace standin::test
