#include "render/visibility/occlusion_probe.h"

#include <algorithm>
#include <limits>

#include "render/base/rng.h"
#include "render/visibility/region_rays.h"

namespace standin {
namespace {

/// Distance at which the ray enters the box; infinity where it misses it.
double entry_distance(const Box& box, const Vec3& origin, const Vec3& direction) {
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (box.min[axis] - origin[axis]) / direction[axis];
    const double b = (box.max[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

constexpr int kProbeRegions = 16;
constexpr int kProbeObjects = 256;
constexpr int kProbeRays = 16;

// Hidden: each of a few rays from the region to the object's box is stopped before it gets there.
bool seems_hidden(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint32_t object, Rng& rng) {
  const Box& bounds = scene.objects[object].bounds;
  if (!intersection(region, bounds).empty()) return false;
  for (int i = 0; i < kProbeRays; ++i) {
    const Vec3 position = random_point(rng, region);
    const Vec3 direction = glm::normalize(random_point(rng, bounds) - position);
    const auto hit = raytracer.nearest(position, direction);
    if (!hit || hit->object == object || hit->distance_m >= entry_distance(bounds, position, direction)) return false;
  }
  return true;
}

}  // namespace

double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed) {
  if (regions.empty() || scene.objects.empty()) return 0.0;
  Rng rng(seed);
  double hidden = 0.0;
  double probed = 0.0;
  for (int r = 0; r < kProbeRegions; ++r) {
    const Box& region = regions[rng.below(regions.size())];
    for (int k = 0; k < kProbeObjects; ++k) {
      const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
      const auto triangles = static_cast<double>(scene.objects[object].triangle_count);
      probed += triangles;
      if (seems_hidden(scene, raytracer, region, object, rng)) hidden += triangles;
    }
  }
  return probed > 0.0 ? hidden / probed : 0.0;
}

}  // namespace standin
