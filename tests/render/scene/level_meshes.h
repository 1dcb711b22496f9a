// Meshes that can be simplified, and scenes of them, for tests of levels of detail.
#pragma once

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <set>
#include <vector>

#include "render/scene/mesh_builder.h"
#include "render/scene/object_levels.h"
#include "render/scene/scene.h"

namespace standin::test {

inline constexpr LevelOptions kLevelOptions{1.2e-3, 2.14, 1};

inline Mesh ball(int n) {
  MeshBuilder builder;
  std::vector<Ring> profile;
  for (int i = 0; i <= n; ++i) profile.push_back({std::max(1e-3, std::sin(3.14159265 * i / n)), -std::cos(3.14159265 * i / n)});
  builder.lathe({0, 0, 0}, profile, 2 * n);
  Mesh mesh = builder.finish("ball");
  update_derived(mesh);
  return mesh;
}

/// Gentle waves over x from 0 to 1, the same along both ends: sheets can be laid end to end.
inline Mesh sheet(double from = 0.0, int n = 20) {
  MeshBuilder builder;
  builder.surface([&](double u, double v) { return Vec3(from + u, 0.05 * std::sin(6.283185307 * u) * std::sin(9 * v), v); }, n, n);
  Mesh mesh = builder.finish("sheet");
  update_derived(mesh);
  return mesh;
}

/// One object for each (mesh, place), of one part, with a texture.
inline Scene scene_of_placed(std::vector<Mesh> meshes, const std::vector<std::pair<std::uint32_t, Mat4>>& places) {
  Scene scene;
  scene.textures.resize(1);
  scene.materials.resize(1);
  scene.materials[0].texture = 0;
  scene.meshes = std::move(meshes);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) scene.parts.push_back({m, 0});
  for (const auto& [mesh, place] : places) {
    Object object;
    object.name = "object";
    object.world_from_object = place;
    object.first_part = mesh;
    object.part_count = 1;
    scene.objects.push_back(object);
  }
  update_derived(scene);
  return scene;
}

/// z of the vertices that lie at x, in mesh space.
inline std::set<float> vertices_at(const Mesh& mesh, float x) {
  std::set<float> along;
  for (const glm::vec3& p : mesh.positions)
    if (p.x == x) along.insert(p.z);
  return along;
}

}  // namespace standin::test
