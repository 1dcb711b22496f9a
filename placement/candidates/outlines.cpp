#include "placement/candidates/outlines.h"

#include <array>

namespace standin {
namespace {

/// To the faces, edges and corners of a cube, one of each opposite pair.
constexpr std::array<std::array<double, 3>, 13> kDirections = {{{1, 0, 0},
                                                                {0, 1, 0},
                                                                {0, 0, 1},
                                                                {1, 1, 0},
                                                                {1, -1, 0},
                                                                {1, 0, 1},
                                                                {1, 0, -1},
                                                                {0, 1, 1},
                                                                {0, 1, -1},
                                                                {1, 1, 1},
                                                                {1, 1, -1},
                                                                {1, -1, 1},
                                                                {1, -1, -1}}};

/// The first of the points that lie farthest along each direction, and against it; each point once.
template <class Points>
std::vector<Vec3> extreme_points(const Points& points) {
  std::array<std::size_t, 2 * kDirections.size()> chosen{};
  for (std::size_t d = 0; d < kDirections.size(); ++d) {
    const Vec3 direction(kDirections[d][0], kDirections[d][1], kDirections[d][2]);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double along = glm::dot(direction, Vec3(points[i]));
      if (along < least) least = along, chosen[2 * d] = i;
      if (along > most) most = along, chosen[2 * d + 1] = i;
    }
  }
  std::sort(chosen.begin(), chosen.end());
  std::vector<Vec3> extremes;
  for (std::size_t k = 0; k < chosen.size() && !points.empty(); ++k)
    if (k == 0 || chosen[k] != chosen[k - 1]) extremes.emplace_back(points[chosen[k]]);
  return extremes;
}

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
