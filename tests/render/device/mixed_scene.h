// Worlds with a bit of everything for property tests: plain, textured, masked, single-sided, mirrored and sheared cubes.
#pragma once

#include "render/base/rng.h"
#include "tests/render/device/device_fixture.h"

namespace standin::test {

inline Texture noise_texture(Rng& rng, bool with_holes) {
  return make_texture(32, 16, [&](int, int) {
    const auto byte = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
    const std::uint8_t alpha = with_holes && rng.below(3) == 0 ? 0 : 255;
    return std::array<std::uint8_t, 4>{byte(), byte(), byte(), alpha};
  });
}

inline Mat4 random_placement(Rng& rng, double half_side_m) {
  Mat4 world_from_object(1.0);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) world_from_object[column][row] = rng.uniform(-1.5, 1.5);
  for (int row = 0; row < 3; ++row) world_from_object[3][row] = rng.uniform(-half_side_m, half_side_m);
  return world_from_object;
}

/// `count` cubes in [-half_side_m, half_side_m]^3, moved by `offset`.
inline Scene mixed_scene(std::uint64_t seed, int count, double half_side_m, const Vec3& offset = Vec3(0.0)) {
  Rng rng(seed);
  Scene scene;
  scene.textures = {noise_texture(rng, false), noise_texture(rng, false), noise_texture(rng, true)};
  for (int i = 0; i < 6; ++i) {
    Material material;
    material.base_colour = {rng.uniform(0.3, 1.0), rng.uniform(0.3, 1.0), rng.uniform(0.3, 1.0), 1.0};
    material.texture = i < 3 ? i : -1;
    material.alpha_mode = i == 2 ? AlphaMode::kMask : AlphaMode::kOpaque;
    material.double_sided = i % 2 == 0;
    material.unlit = i == 5;
    add_material(scene, material);
  }
  add_mesh(scene, make_cube());
  for (int i = 0; i < count; ++i) {
    const Mat4 placement = random_placement(rng, half_side_m);
    add_object(scene, 0, static_cast<std::uint32_t>(rng.below(6)), translation(offset) * placement);
  }
  update_derived(scene);
  return scene;
}

inline View random_view(Rng& rng, double half_side_m) {
  const auto coordinate = [&] { return rng.uniform(-half_side_m, half_side_m); };
  const Vec3 position(coordinate(), coordinate(), coordinate());
  return {.position = position, .direction = glm::normalize(Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-0.5, 0.5), rng.uniform(-1.0, 1.0)))};
}

}  // namespace standin::test
