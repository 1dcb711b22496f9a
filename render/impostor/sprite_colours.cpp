#include "render/impostor/sprite_colours.h"

#include <cmath>

#include "render/impostor/recorder.h"
#include "render/impostor/slab_piece.h"

namespace standin {
namespace {

constexpr double kLeastFacing = 0.2;  // cosine to the ray below which the image holds a fifth of the texels that the triangle has

std::vector<std::array<Vec3, 3>> corners_of(const std::vector<SurfaceTriangle>& surface) {
  std::vector<std::array<Vec3, 3>> corners;
  for (const SurfaceTriangle& triangle : surface) corners.push_back(triangle.corners);
  return corners;
}

/// Pyramid level at which a texel of the texture is as large as one of `texel_m` on the triangle, by their areas.
double level_of(const SurfaceTriangle& triangle, const TexturePyramid& texture, double texel_m) {
  const auto& uv = triangle.attributes.uv;
  const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
  const double texture_texels = std::abs(a.x * b.y - a.y * b.x) * texture.width() * texture.height();
  const double area_m2 = glm::length(glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]));
  const double texels2 = texture_texels * texel_m * texel_m / area_m2;
  return texels2 > 1.0 ? std::min(0.5 * std::log2(texels2), static_cast<double>(texture.coarsest_level())) : 0.0;
}

}  // namespace

SpriteColours::SpriteColours(const Scene& scene, const TexturePyramids& textures, const std::vector<SurfaceTriangle>& surface,
                             const ImpostorFrame& frame, const LayerImage& image, const Layer& layer, std::span<const Vec3> viewpoints,
                             double alpha_rad)
    : scene_(scene),
      textures_(textures),
      surface_(surface),
      frame_(frame),
      image_(image),
      layer_(layer),
      viewpoints_(viewpoints),
      alpha_rad_(alpha_rad),
      tree_(corners_of(surface)) {}

std::array<std::uint8_t, 4> SpriteColours::at(const Vec3& offset, const Vec3& normal) const {
  const auto projected = of_image(offset, normal);
  return projected ? *projected : of_surface(offset, normal);
}

std::optional<std::array<std::uint8_t, 4>> SpriteColours::of_image(const Vec3& offset, const Vec3& normal) const {
  if (std::abs(glm::dot(normal, offset)) < kLeastFacing * glm::length(offset)) return std::nullopt;
  const double depth = glm::dot(offset, frame_.forward);
  const Vec2 texel = glm::floor(texel_from_slope(frame_, Vec2(glm::dot(offset, frame_.right), glm::dot(offset, frame_.up)) / depth));
  if (texel.x < 0.0 || texel.y < 0.0 || texel.x >= frame_.width || texel.y >= frame_.height) return std::nullopt;
  const RecordedTexel& shown = image_.get(static_cast<std::uint32_t>(texel.x), static_cast<std::uint32_t>(texel.y));
  if (!shown.opaque()) return std::nullopt;
  const Vec3 shown_point = depth_m(shown, layer_) / depth * offset;
  if (!appears_within(viewpoints_, shown_point, offset, alpha_rad_)) return std::nullopt;
  return shown.rgba;
}

std::array<std::uint8_t, 4> SpriteColours::of_surface(const Vec3& offset, const Vec3& normal) const {
  const double texel_m = frame_.slope_step.x * glm::dot(offset, frame_.forward);
  // Of surfaces about as near, the one that faces the same way.
  const auto penalty = [&](std::uint32_t t) {
    return 2.0 * texel_m * (1.0 - std::abs(glm::dot(normal, unit_normal(surface_[t].corners))));
  };
  const auto nearest = tree_.nearest(offset, std::numeric_limits<double>::infinity(), penalty);
  const SurfaceTriangle& triangle = surface_[nearest->triangle];
  const TexturePyramid* texture = triangle.textured ? textures_.of_material(triangle.material) : nullptr;
  const double level = texture != nullptr ? level_of(triangle, *texture, texel_m) : 0.0;
  return Surface(scene_.materials[triangle.material], texture).colour(triangle.attributes, nearest->barycentric, level);
}

}  // namespace standin
