// What a recorded surface looks like: the rule of render/scene/shading.h at one point of a triangle.
#pragma once

#include <array>

#include "render/impostor/texture_pyramid.h"
#include "render/scene/scene.h"

namespace standin {

/// Attributes at a triangle's corners. Normals are world directions of any length, as the device interpolates them.
struct TriangleAttributes {
  std::array<Vec2, 3> uv{Vec2(0.0), Vec2(0.0), Vec2(0.0)};
  std::array<Vec3, 3> normal{Vec3(0.0), Vec3(0.0), Vec3(0.0)};

  [[nodiscard]] Vec2 uv_at(const Vec3& barycentric) const { return barycentric.x * uv[0] + barycentric.y * uv[1] + barycentric.z * uv[2]; }
  [[nodiscard]] Vec3 normal_at(const Vec3& barycentric) const {
    return barycentric.x * normal[0] + barycentric.y * normal[1] + barycentric.z * normal[2];
  }
};

class Surface {
 public:
  /// `pyramid` is null where the material or the mesh has no texture coordinates.
  Surface(const Material& material, const TexturePyramid* pyramid);

  /// False where a mask without texture hides everything.
  [[nodiscard]] bool ever_opaque() const { return pyramid_ != nullptr || least_passing_alpha(material_) <= 255; }
  /// The texture whose mask decides what is opaque; null where all is.
  [[nodiscard]] const TexturePyramid* mask() const { return masked_ ? pyramid_ : nullptr; }
  [[nodiscard]] const TexturePyramid* texture() const { return pyramid_; }

  /// RGBA8, alpha 255. `level` is the pyramid's, 0 where one texel of the impostor spans one of the texture.
  [[nodiscard]] std::array<std::uint8_t, 4> colour(const TriangleAttributes& triangle, const Vec3& barycentric, double level) const;

 private:
  const Material& material_;
  const TexturePyramid* pyramid_;
  bool masked_;
};

}  // namespace standin
