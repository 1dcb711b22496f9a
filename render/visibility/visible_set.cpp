#include "render/visibility/visible_set.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/base/parallel.h"
#include "render/base/rng.h"

namespace standin {
namespace {

constexpr std::uint64_t kRaysPerCheck = 1 << 14;

Vec3 random_point(Rng& rng, const Box& box) {
  const double x = rng.uniform();
  const double y = rng.uniform();
  const double z = rng.uniform();
  return box.min + Vec3(x, y, z) * box.size();
}

Vec3 random_direction(Rng& rng) {
  const double along = rng.uniform(-1.0, 1.0);
  const double turn = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(std::max(0.0, 1.0 - along * along));
  return {radius * std::cos(turn), along, radius * std::sin(turn)};
}

bool meet(const Box& a, const Box& b) {
  return !intersection(a, b).empty();
}

// How often each object was the first thing a ray met; `certain` holds those that need no ray or were found by an aimed one.
struct Finds {
  std::vector<std::uint32_t> uniform_hits;
  std::vector<bool> certain;
};

void shoot_uniform(const Raytracer& raytracer, const Box& region, std::uint64_t rays, Rng& rng, const WorkBudget& budget, Finds& finds) {
  for (std::uint64_t i = 0; i < rays; ++i) {
    if (i % kRaysPerCheck == 0) budget.check();
    const Vec3 position = random_point(rng, region);
    if (const auto hit = raytracer.nearest(position, random_direction(rng))) ++finds.uniform_hits[hit->object];
  }
}

// Each object gets the same number of rays on average, however small it looks.
void shoot_aimed(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint64_t rays, Rng& rng, const WorkBudget& budget,
                 Finds& finds) {
  for (std::uint64_t i = 0; i < rays; ++i) {
    if (i % kRaysPerCheck == 0) budget.check();
    const Vec3 position = random_point(rng, region);
    const Vec3 way = random_point(rng, scene.objects[rng.below(scene.objects.size())].bounds) - position;
    const double length = glm::length(way);
    if (!(length > 0.0)) continue;
    if (const auto hit = raytracer.nearest(position, way / length)) finds.certain[hit->object] = true;
  }
}

// Good and Turing: the share of rays that would meet something new is that of the rays whose find no other ray has confirmed.
VisibleSet summary(const Finds& finds, std::uint64_t uniform_rays) {
  VisibleSet set;
  std::uint64_t singletons = 0;
  for (std::uint32_t object = 0; object < finds.certain.size(); ++object) {
    if (finds.certain[object] || finds.uniform_hits[object] > 0) set.objects.push_back(object);
    if (!finds.certain[object] && finds.uniform_hits[object] == 1) ++singletons;
  }
  set.missed_ray_share = uniform_rays > 0 ? static_cast<double>(singletons) / static_cast<double>(uniform_rays) : 1.0;
  return set;
}

VisibleSet sample_region(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint64_t rays, Rng rng,
                         const WorkBudget& budget) {
  Finds finds{std::vector<std::uint32_t>(scene.objects.size()), std::vector<bool>(scene.objects.size())};
  if (scene.objects.empty()) return {};
  for (std::size_t object = 0; object < scene.objects.size(); ++object) finds.certain[object] = meet(region, scene.objects[object].bounds);
  const std::uint64_t uniform_rays = rays - rays / 2;
  shoot_uniform(raytracer, region, uniform_rays, rng, budget, finds);
  shoot_aimed(scene, raytracer, region, rays / 2, rng, budget, finds);
  return summary(finds, uniform_rays);
}

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
  if (meet(region, bounds)) return false;
  for (int i = 0; i < kProbeRays; ++i) {
    const Vec3 position = random_point(rng, region);
    const Vec3 direction = glm::normalize(random_point(rng, bounds) - position);
    const auto hit = raytracer.nearest(position, direction);
    if (!hit || hit->object == object || hit->distance_m >= entry_distance(bounds, position, direction)) return false;
  }
  return true;
}

}  // namespace

std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                            const VisibilityOptions& options, int threads, const WorkBudget& budget) {
  std::vector<VisibleSet> sets(regions.size());
  std::atomic<std::size_t> done{0};
  parallel_for(regions.size(), threads, budget, [&](std::size_t i) {
    sets[i] = sample_region(scene, raytracer, regions[i], options.rays, Rng(options.seed, i), budget);
    budget.report("visibility", static_cast<double>(++done) / static_cast<double>(regions.size()));
  });
  return sets;
}

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
