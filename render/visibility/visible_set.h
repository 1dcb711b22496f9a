// From-region visibility by plain ray sampling: which objects can be seen from a box of positions (a certified, aimed sampler is a later
// step).
//
// Uniform random position and direction; objects whose bounds meet the box are always visible. The missed share is stated as Good and
// Turing's estimate: singletons / rays.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/work.h"
#include "render/visibility/raytracer.h"

namespace standin {

struct VisibilityOptions {
  std::uint64_t rays = 200'000;  // per region
  std::uint64_t seed = 1;
};

struct VisibleSet {
  std::vector<std::uint32_t> objects;  // ascending
  double missed_ray_share = 0.0;       // Good-Turing estimate, 0..1
};

/// One set per region, independent of the number of threads.
[[nodiscard]] std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                                          const VisibilityOptions& options, int threads, const WorkBudget& budget);

/// Whether the scene has occlusion to gain: the mean share of triangles in sampled regions' view that is hidden, from a quick probe. 0:
/// none.
[[nodiscard]] double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed);

}  // namespace standin
