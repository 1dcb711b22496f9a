#include "placement/candidates/outlines.h"

#include "render/scene/extreme_points.h"

namespace standin {
namespace {

std::vector<Vec3> outline_of(const Object& object, const Scene& scene, const std::vector<std::vector<Vec3>>& of_mesh) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < object.part_count; ++i)
    for (const Vec3& point : of_mesh[scene.parts[object.first_part + i].mesh])
      points.emplace_back(object.world_from_object * Vec4(point, 1.0));
  if (points.empty())
    for (int i = 0; i < 8; ++i) points.push_back(object.bounds.corner(i));
  return extreme_points(points);
}

}  // namespace

ObjectOutlines::ObjectOutlines(const Scene& scene) {
  std::vector<std::vector<Vec3>> of_mesh;
  for (const Mesh& mesh : scene.meshes) of_mesh.push_back(extreme_points(mesh.positions));
  for (const Object& object : scene.objects) {
    const std::vector<Vec3> points = outline_of(object, scene, of_mesh);
    points_.insert(points_.end(), points.begin(), points.end());
    first_.push_back(points_.size());
  }
}

std::vector<Vec3> ObjectOutlines::of(std::span<const std::uint32_t> objects) const {
  std::vector<Vec3> points;
  for (const std::uint32_t object : objects) points.insert(points.end(), of(object).begin(), of(object).end());
  return points;
}

}  // namespace standin
