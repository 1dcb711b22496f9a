// Three objects with everything that a stage may look at: a masked pane, a textured cube with a level of detail, a plain cube.
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/scene_builder.h"

namespace standin::test {

inline constexpr std::uint32_t kPane = 0, kCrate = 1, kBlock = 2;

[[nodiscard]] inline Mat4 moved_by(const Vec3& by) {
  return glm::translate(Mat4(1.0), by);
}

[[nodiscard]] inline Scene painted_scene() {
  Scene scene;
  const auto stripes = [](std::uint8_t red) {
    return make_texture(8, 8, [=](int x, int y) {
      return std::array<std::uint8_t, 4>{red, static_cast<std::uint8_t>(20 * y), 9, static_cast<std::uint8_t>(x % 2 == 0 ? 255 : 0)};
    });
  };
  scene.textures = {stripes(200), stripes(100)};
  Material leaves;
  leaves.texture = 0;
  leaves.alpha_mode = AlphaMode::kMask;
  Material wood;
  wood.texture = 1;
  const auto leaf = add_material(scene, leaves), wooden = add_material(scene, wood), plain = add_material(scene, Material{});
  add_object(scene, add_mesh(scene, make_rectangle(-2.0, 0.0, 2.0, 4.0, 0.0)), leaf, moved_by({-5.0, 0.0, 0.0}));
  add_object(scene, add_mesh(scene, make_cube()), wooden, moved_by({0.0, 1.0, 1.0}));
  add_object(scene, add_mesh(scene, make_cube()), plain, moved_by({5.0, 1.0, 0.0}));
  scene.parts.push_back({scene.parts[kCrate].mesh, plain});
  scene.objects[kCrate].levels.push_back({.first_part = 3, .part_count = 1, .triangle_count = 12, .least_distance_m = 50.0});
  update_derived(scene);
  return scene;
}

/// The same with one more object in front of the others in every list: a car far away. All numbers shift by one.
[[nodiscard]] inline Scene with_one_in_front(Scene scene) {
  Scene with;
  with.textures.push_back(make_texture(2, 2, [](int, int) { return std::array<std::uint8_t, 4>{1, 2, 3, 255}; }));
  with.textures.insert(with.textures.end(), scene.textures.begin(), scene.textures.end());
  Material paint;
  paint.texture = 0;
  add_material(with, paint);
  for (Material& material : scene.materials) {
    if (material.texture >= 0) ++material.texture;
    with.materials.push_back(material);
  }
  add_object(with, add_mesh(with, make_cube()), 0, moved_by({0.0, 1.0, 4.0}));
  with.meshes.insert(with.meshes.end(), scene.meshes.begin(), scene.meshes.end());
  for (const Part& part : scene.parts) with.parts.push_back({part.mesh + 1, part.material + 1});
  for (Object& object : scene.objects) {
    ++object.first_part;
    for (ObjectLevel& level : object.levels) ++level.first_part;
    with.objects.push_back(object);
  }
  update_derived(with);
  return with;
}

}  // namespace standin::test
