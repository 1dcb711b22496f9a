#include "estimation/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace standin {
namespace {

struct Triangle {
  Vec3 a{0.0}, b{0.0}, c{0.0};

  [[nodiscard]] Vec3 vector_area_m2() const { return 0.5 * glm::cross(b - a, c - a); }
  [[nodiscard]] double area_m2() const { return glm::length(vector_area_m2()); }
  [[nodiscard]] double edges_m() const { return glm::length(b - a) + glm::length(c - b) + glm::length(a - c); }
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

/// What a mesh's triangles add up to.
struct Totals {
  double area_m2 = 0.0;
  double edges_m = 0.0;
  double triangles = 0.0;
};

Totals totals_of(const Mesh& mesh) {
  Totals sum;
  sum.triangles = static_cast<double>(mesh.triangle_count());
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const Triangle triangle = triangle_of(mesh, i);
    sum.area_m2 += triangle.area_m2();
    sum.edges_m += triangle.edges_m();
  }
  return sum;
}

double share(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

double ratio_or_zero(double wanted, double got) {
  return got > 0.0 ? wanted / got : 0.0;
}

/// What is sampled adds up to the mesh only on average; made exact.
void scale_to(const Totals& totals, std::vector<SurfaceSample>& samples) {
  Totals sampled;
  for (const SurfaceSample& sample : samples) {
    sampled.area_m2 += glm::length(sample.vector_area_m2);
    sampled.edges_m += sample.edges_m;
    sampled.triangles += sample.triangles;
  }
  for (SurfaceSample& sample : samples) {
    sample.vector_area_m2 *= ratio_or_zero(totals.area_m2, sampled.area_m2);
    sample.edges_m *= ratio_or_zero(totals.edges_m, sampled.edges_m);
    sample.triangles *= ratio_or_zero(totals.triangles, sampled.triangles);
  }
}

// Halves at the median of the longest side, each time at a whole number of groups.
void group(std::span<SurfaceSample> samples) {
  if (samples.size() <= kSampleGroup) return;
  Box bounds;
  for (const SurfaceSample& sample : samples) bounds.extend(sample.point);
  const Vec3 size = bounds.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = half_of_groups(samples.size());
  std::ranges::stable_sort(samples, {}, [axis](const SurfaceSample& sample) { return sample.point[axis]; });
  group(samples.first(half));
  group(samples.subspan(half));
}

std::vector<SurfaceSample> draw_samples(const Mesh& mesh, const Totals& totals, std::uint32_t count) {
  const auto importance_of = [&](const Triangle& triangle) {
    return 1.0 / totals.triangles + share(triangle.area_m2(), totals.area_m2) + share(triangle.edges_m(), totals.edges_m);
  };
  const double whole = 1.0 + (totals.area_m2 > 0.0 ? 1.0 : 0.0) + (totals.edges_m > 0.0 ? 1.0 : 0.0);
  const double step = whole / count;
  std::vector<SurfaceSample> samples;
  double passed = 0.0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const Triangle triangle = triangle_of(mesh, i);
    const double importance = importance_of(triangle);
    const double stands_for = step / importance;
    passed += importance;
    while (samples.size() < count && (static_cast<double>(samples.size()) + 0.5) * step <= passed) {
      const Vec2 place = spread(static_cast<std::uint32_t>(samples.size()));
      samples.push_back(
          {triangle.at(place.x, place.y), stands_for * triangle.vector_area_m2(), stands_for * triangle.edges_m(), stands_for});
    }
  }
  scale_to(totals, samples);
  group(samples);
  return samples;
}

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, std::uint32_t count) {
  if (mesh.triangle_count() == 0) return {};
  const Totals totals = totals_of(mesh);
  const double slenderness = ratio_or_zero(totals.edges_m, std::sqrt(totals.triangles * totals.area_m2));
  return {draw_samples(mesh, totals, count), draw_samples(mesh, totals, kNearFactor * count), slenderness};
}

SurfaceSamples simplified_samples(const SurfaceSamples& finer, const Mesh& mesh) {
  Totals known;
  for (const SurfaceSample& sample : finer.samples) {
    known.edges_m += sample.edges_m;
    known.triangles += sample.triangles;
  }
  const Totals totals = totals_of(mesh);
  const double edges = std::min(1.0, ratio_or_zero(totals.edges_m, known.edges_m));
  const double triangles = std::min(1.0, ratio_or_zero(totals.triangles, known.triangles));
  SurfaceSamples result = finer;
  for (auto* samples : {&result.samples, &result.near_samples})
    for (SurfaceSample& sample : *samples) {
      sample.edges_m *= edges;
      sample.triangles *= triangles;
    }
  result.slenderness *= edges / std::sqrt(triangles);
  return result;
}

}  // namespace standin
