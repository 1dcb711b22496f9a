// Scenes made of a few meshes for tests of features: quads whose pixels follow by hand, and random triangle soups.
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "render/base/rng.h"
#include "render/scene/scene.h"

namespace standin::test {

inline Mesh mesh_of(const std::vector<glm::vec3>& triangle_corners) {
  Mesh mesh;
  for (const glm::vec3& corner : triangle_corners) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(corner);
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
    mesh.uvs.emplace_back(corner.x, corner.y);
  }
  return mesh;
}

/// `cells` x `cells` squares of two triangles on [-half, half]^2 at z = 0, facing +z.
inline Mesh grid_mesh(float half, int cells) {
  std::vector<glm::vec3> corners;
  const float step = 2.0F * half / static_cast<float>(cells);
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const float x = -half + static_cast<float>(i) * step, y = -half + static_cast<float>(j) * step;
      for (const auto& corner : {glm::vec3(x, y, 0), glm::vec3(x + step, y, 0), glm::vec3(x + step, y + step, 0), glm::vec3(x, y, 0),
                                 glm::vec3(x + step, y + step, 0), glm::vec3(x, y + step, 0)})
        corners.push_back(corner);
    }
  return mesh_of(corners);
}

inline Mesh random_mesh(Rng& rng, int triangles) {
  std::vector<glm::vec3> corners;
  const auto coordinate = [&](double scale) { return static_cast<float>(scale * rng.uniform(-1.0, 1.0)); };
  for (int i = 0; i < triangles; ++i) {
    const double size = std::pow(10.0, rng.uniform(-3.0, 0.0));
    const glm::vec3 centre(coordinate(1.0), coordinate(1.0), coordinate(1.0));
    for (int k = 0; k < 3; ++k) corners.push_back(centre + glm::vec3(coordinate(size), coordinate(size), coordinate(size)));
  }
  return mesh_of(corners);
}

/// An object of one part with its own mesh and material; a texture where `textured`.
inline void add_object(Scene& scene, Mesh mesh, const Mat4& world_from_object, bool textured, AlphaMode alpha_mode = AlphaMode::kOpaque,
                       bool double_sided = true) {
  if (scene.textures.empty()) scene.textures.push_back({"white", 1, 1, {255, 255, 255, 255}});
  Material material;
  material.texture = textured ? 0 : -1;
  material.alpha_mode = alpha_mode;
  material.double_sided = double_sided;
  Object object;
  object.world_from_object = world_from_object;
  object.first_part = static_cast<std::uint32_t>(scene.parts.size());
  object.part_count = 1;
  scene.parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), static_cast<std::uint32_t>(scene.materials.size())});
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back(material);
  scene.objects.push_back(object);
  update_derived(scene);
}

inline Vec3 random_unit(Rng& rng) {
  for (;;) {
    const double x = rng.uniform(-1.0, 1.0), y = rng.uniform(-1.0, 1.0), z = rng.uniform(-1.0, 1.0);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 0.1 && length <= 1.0) return Vec3(x, y, z) / length;
  }
}

inline Mat4 moved(double x, double y, double z) {
  return glm::translate(Mat4(1.0), Vec3(x, y, z));
}

inline Scene random_scene(Rng& rng) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const Mat4 transform = moved(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-5, 5)) *
                           glm::rotate(Mat4(1.0), rng.uniform(0, 6), random_unit(rng)) *
                           glm::scale(Mat4(1.0), Vec3(rng.uniform(0.1, 3), rng.uniform(-3, -0.1), rng.uniform(0.1, 3)));
    Mesh mesh = i == 0 ? grid_mesh(2.0F, 3) : random_mesh(rng, static_cast<int>(1 + rng.below(200)));
    add_object(scene, std::move(mesh), transform, i % 2 == 0, i == 2 ? AlphaMode::kMask : AlphaMode::kOpaque, i != 3);
  }
  return scene;
}

/// Every object at three further levels: half, a quarter, an eighth of its triangles, from ever farther.
inline Scene with_levels(Scene scene, Rng& rng) {
  for (Object& object : scene.objects) {
    const auto original = scene.parts[object.first_part];
    double distance_m = 0.0;
    for (int k = 1; k <= 3; ++k) {
      Mesh simple = scene.meshes[original.mesh];
      simple.indices.resize(std::max<std::size_t>(3, (simple.indices.size() >> k) / 3 * 3));
      simple.simplified_from = static_cast<std::int32_t>(original.mesh);
      distance_m += std::pow(10.0, rng.uniform(-1.5, 1.0));
      object.levels.push_back({static_cast<std::uint32_t>(scene.parts.size()), 1, simple.triangle_count(), 0.0, -1.0, distance_m});
      scene.parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), original.material});
      scene.meshes.push_back(std::move(simple));
    }
  }
  update_derived(scene);
  return scene;
}

}  // namespace standin::test
