#include "render/impostor/surface.h"

#include <algorithm>
#include <cmath>

#include "render/scene/shading.h"

namespace standin {
namespace {

double brightness(const Vec3& normal) {
  static const Vec3 light = light_direction();
  const double length = glm::length(normal);
  return kAmbient + (length > 0.0 ? kDiffuse * std::abs(glm::dot(normal, light)) / length : 0.0);
}

}  // namespace

Surface::Surface(const Material& material, const TexturePyramid* pyramid)
    : material_(material), pyramid_(pyramid), masked_(material.alpha_mode == AlphaMode::kMask) {}

std::array<std::uint8_t, 4> Surface::colour(const TriangleAttributes& triangle, const Vec3& barycentric, double level) const {
  glm::vec3 colour(material_.base_colour);
  if (pyramid_ != nullptr) colour *= pyramid_->sample(triangle.uv_at(barycentric), level).colour;
  if (!material_.unlit) colour *= static_cast<float>(brightness(triangle.normal_at(barycentric)));
  const auto byte = [](float channel) { return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(channel, 0.0F, 1.0F))); };
  return {byte(colour.r), byte(colour.g), byte(colour.b), 255};
}

}  // namespace standin
