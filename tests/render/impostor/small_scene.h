// Scenes of a few triangles, built by hand or from a seed.
#pragma once

#include <vector>

#include "render/base/rng.h"
#include "render/scene/scene.h"

namespace standin::test {

using WorldTriangle = std::array<Vec3, 3>;

/// One object per call, with its own mesh and material.
class SmallScene {
 public:
  std::uint32_t add_object(const std::vector<WorldTriangle>& triangles, const Material& material = white(),
                           const std::vector<std::array<Vec2, 3>>& uvs = {}) {
    Mesh mesh;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Vec3 cross = glm::cross(triangles[i][1] - triangles[i][0], triangles[i][2] - triangles[i][0]);
      const double length = glm::length(cross);
      for (std::size_t k = 0; k < 3; ++k) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        mesh.positions.emplace_back(triangles[i][k]);
        mesh.normals.emplace_back(length > 0.0 ? cross / length : Vec3(0.0, 1.0, 0.0));
        mesh.bounds.extend(Vec3(mesh.positions.back()));
        if (!uvs.empty()) mesh.uvs.emplace_back(uvs[i][k]);
      }
    }
    Object object;
    object.first_part = static_cast<std::uint32_t>(scene.parts.size());
    object.part_count = 1;
    object.bounds = mesh.bounds;
    object.triangle_count = triangles.size();
    scene.parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), static_cast<std::uint32_t>(scene.materials.size())});
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back(material);
    scene.objects.push_back(object);
    return static_cast<std::uint32_t>(scene.objects.size()) - 1;
  }

  /// Unlit, so that recorded colours are the material's.
  static Material white() {
    Material material;
    material.unlit = true;
    return material;
  }

  Scene scene;
};

/// Rectangle from a corner along two sides; uv (0,0) at the corner, (1,0) along the first side, (0,1) along the second.
[[nodiscard]] inline std::vector<WorldTriangle> rectangle(const Vec3& corner, const Vec3& first, const Vec3& second) {
  return {{corner, corner + first, corner + first + second}, {corner, corner + first + second, corner + second}};
}

[[nodiscard]] inline std::vector<std::array<Vec2, 3>> rectangle_uvs(const Vec2& size = Vec2(1.0)) {
  return {{Vec2(0.0), Vec2(size.x, 0.0), size}, {Vec2(0.0), size, Vec2(0.0, size.y)}};
}

[[nodiscard]] inline Vec3 random_point(Rng& rng, const Box& box) {
  const double x = rng.uniform(box.min.x, box.max.x), y = rng.uniform(box.min.y, box.max.y);
  return {x, y, rng.uniform(box.min.z, box.max.z)};
}

/// Vertices as the scene stores them (float), for judges that must see the same geometry.
[[nodiscard]] inline std::vector<WorldTriangle> random_triangles(Rng& rng, const Box& box, int count) {
  std::vector<WorldTriangle> triangles;
  for (int i = 0; i < count; ++i) {
    WorldTriangle triangle;
    for (Vec3& corner : triangle) corner = Vec3(glm::vec3(random_point(rng, box)));
    triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace standin::test
