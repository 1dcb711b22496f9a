// Bounds, areas and counts: what follows from meshes and transforms.

#include <cmath>

#include "render/scene/scene.h"

namespace standin {
namespace {

double area_of(const Mesh& mesh, const Mat3& linear) {
  double twice_area = 0.0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Vec3 a = mesh.positions[mesh.indices[i]];
    const Vec3 ab = linear * (Vec3(mesh.positions[mesh.indices[i + 1]]) - a);
    const Vec3 ac = linear * (Vec3(mesh.positions[mesh.indices[i + 2]]) - a);
    twice_area += glm::length(glm::cross(ab, ac));
  }
  return 0.5 * twice_area;
}

// The factor by which `linear` scales every area, or a negative value if it stretches directions differently.
double area_scale(const Mat3& linear) {
  const Mat3 gram = glm::transpose(linear) * linear;
  const double scale = gram[0][0];
  double deviation = 0.0;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) deviation = std::max(deviation, std::abs(gram[column][row] - (column == row ? scale : 0.0)));
  }
  return deviation <= 1e-12 * scale ? scale : -1.0;
}

Box world_bounds(const Mesh& mesh, const Mat4& world_from_object) {
  Box bounds;
  for (const glm::vec3& position : mesh.positions) bounds.extend(Vec3(world_from_object * Vec4(Vec3(position), 1.0)));
  return bounds;
}

void update(Object& object, const Scene& scene) {
  const Mat3 linear(object.world_from_object);
  const double scale = area_scale(linear);
  object.bounds = Box();
  object.triangle_count = 0;
  object.area_m2 = 0.0;
  for (std::uint32_t p = 0; p < object.part_count; ++p) {
    const Mesh& mesh = scene.meshes[scene.parts[object.first_part + p].mesh];
    object.bounds.extend(world_bounds(mesh, object.world_from_object));
    object.triangle_count += mesh.triangle_count();
    object.area_m2 += scale >= 0.0 ? scale * mesh.area_m2 : area_of(mesh, linear);
  }
}

}  // namespace

bool is_exhibit(const Scene& scene) {
  const Vec3 size = scene.bounds.size();
  return scene.objects.size() == 1 || std::max({size.x, size.y, size.z}) <= 3.0 * std::min({size.x, size.y, size.z});
}

void update_derived(Mesh& mesh) {
  mesh.bounds = Box();
  for (const glm::vec3& position : mesh.positions) mesh.bounds.extend(Vec3(position));
  mesh.area_m2 = area_of(mesh, Mat3(1.0));
}

void update_derived(Scene& scene) {
  for (Mesh& mesh : scene.meshes) update_derived(mesh);
  scene.bounds = Box();
  for (Object& object : scene.objects) {
    update(object, scene);
    scene.bounds.extend(object.bounds);
  }
}

}  // namespace standin
