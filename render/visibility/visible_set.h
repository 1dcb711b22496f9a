// From-region visibility by plain ray sampling: which objects can be seen from a box of positions (a certified, aimed sampler is a later
// step).
//
// Half the rays have a uniform random position and direction; the other half are aimed from a uniform position at a random point of a
// random object's bounds, every object equally often, since small and far objects are found that way. Objects whose bounds meet the box are
// always visible. The missed share is Good and Turing's estimate over the uniform half: the expected share of further uniform rays whose
// first hit is no member of the set, = objects that a single uniform ray found and nothing else confirms / uniform rays.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/work.h"
#include "render/visibility/raytracer.h"

namespace standin {

struct VisibilityOptions {
  std::uint64_t rays = 200'000;  // per region, both halves together
  std::uint64_t seed = 1;
};

struct VisibleSet {
  std::vector<std::uint32_t> objects;  // ascending
  double missed_ray_share = 0.0;       // Good-Turing estimate, 0..1
};

/// One set per region, independent of the number of threads.
[[nodiscard]] std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                                          const VisibilityOptions& options, int threads, const WorkBudget& budget);

/// Whether the scene has occlusion to gain: the mean share of triangles that is hidden from sampled regions, from a quick probe (65
/// thousand rays aimed at sampled objects, each hidden if every ray to it is stopped before its bounds). 0: none.
[[nodiscard]] double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed);

}  // namespace standin
