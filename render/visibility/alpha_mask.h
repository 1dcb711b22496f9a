// Which texels of an alpha-masked material a ray passes through.
//
// Nearest texel, repeated outside [0, 1): the same test at every distance, so that visibility does not depend on filtering.
#pragma once

#include <cmath>

#include "render/scene/scene.h"

namespace standin {

/// Index in 0..count-1 of the texel that holds coordinate `u` of a repeating texture.
[[nodiscard]] inline std::size_t repeated_texel(float u, int count) {
  const auto texel = static_cast<int>((u - std::floor(u)) * static_cast<float>(count));
  return static_cast<std::size_t>(std::min(texel, count - 1));
}

/// False where the material is masked and base alpha times texture alpha lies below its cutoff. No texture counts where `uv` has no
/// meaning.
[[nodiscard]] inline bool is_opaque(const Scene& scene, const Material& material, const Mesh& mesh, std::uint32_t triangle, float u,
                                    float v) {
  if (material.alpha_mode != AlphaMode::kMask) return true;
  float alpha = material.base_colour.a;
  if (material.texture >= 0 && !mesh.uvs.empty()) {
    const Texture& texture = scene.textures[static_cast<std::size_t>(material.texture)];
    const auto corner = [&](std::size_t k) { return mesh.uvs[mesh.indices[3 * std::size_t{triangle} + k]]; };
    const glm::vec2 uv = (1.0F - u - v) * corner(0) + u * corner(1) + v * corner(2);
    const std::size_t texel =
        repeated_texel(uv.y, texture.height) * static_cast<std::size_t>(texture.width) + repeated_texel(uv.x, texture.width);
    alpha *= static_cast<float>(texture.rgba[4 * texel + 3]) / 255.0F;
  }
  return alpha >= material.alpha_cutoff;
}

}  // namespace standin
