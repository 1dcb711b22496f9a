#include "estimation/surface_samples.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

struct Triangle {
  Vec3 a{0.0}, b{0.0}, c{0.0};

  [[nodiscard]] Vec3 vector_area_m2() const { return 0.5 * glm::cross(b - a, c - a); }
  [[nodiscard]] double area_m2() const { return glm::length(vector_area_m2()); }
  [[nodiscard]] Vec3 centroid() const { return (a + b + c) / 3.0; }
  /// Maps the unit square evenly onto the triangle.
  [[nodiscard]] Vec3 at(double s, double t) const {
    const double root = std::sqrt(s);
    return (1.0 - root) * a + root * (1.0 - t) * b + root * t * c;
  }
};

Triangle triangle_of(const Mesh& mesh, std::size_t index) {
  const std::uint32_t* corner = mesh.indices.data() + 3 * index;
  return {mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]};
}

/// The plastic-number sequence (Roberts 2018): evenly spread over the unit square in every prefix.
Vec2 spread(std::uint32_t i) {
  const double x = 0.5 + 0.7548776662466927 * i;
  const double y = 0.5 + 0.5698402909980532 * i;
  return {x - std::floor(x), y - std::floor(y)};
}

double total_area_m2(const Mesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) sum += triangle_of(mesh, i).area_m2();
  return sum;
}

std::vector<SurfacePatch> patches_by_area(const Mesh& mesh, std::uint32_t count) {
  std::vector<SurfacePatch> patches;
  const double step_m2 = total_area_m2(mesh) / count;
  if (!(step_m2 > 0.0)) return patches;
  double passed_m2 = 0.0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const Triangle triangle = triangle_of(mesh, i);
    const double area_m2 = triangle.area_m2();
    passed_m2 += area_m2;
    while (patches.size() < count && (static_cast<double>(patches.size()) + 0.5) * step_m2 <= passed_m2) {
      const Vec2 place = spread(static_cast<std::uint32_t>(patches.size()));
      patches.push_back({triangle.at(place.x, place.y), triangle.vector_area_m2() * (step_m2 / area_m2)});
    }
  }
  return patches;
}

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, std::uint32_t count) {
  SurfaceSamples samples;
  const std::size_t triangles = mesh.triangle_count();
  if (triangles == 0) return samples;
  samples.patches = patches_by_area(mesh, count);
  samples.near_patches = patches_by_area(mesh, kNearFactor * count);
  const std::size_t taken = std::min<std::size_t>(triangles, count);
  samples.triangles_per_sample = static_cast<double>(triangles) / static_cast<double>(taken);
  for (std::size_t i = 0; i < taken; ++i) {
    const Triangle triangle = triangle_of(mesh, (2 * i + 1) * triangles / (2 * taken));
    samples.triangles.push_back({triangle.centroid(), triangle.vector_area_m2()});
  }
  return samples;
}

}  // namespace standin
