// From-region visibility by ray sampling: which objects can be seen from a box of positions.
//
// Rounds, each of rays aimed at all objects not found yet and a batch of rays uniform in position and direction (spread evenly over the
// sphere), until a whole batch of 46,208 meets nothing new. Around every find a few rays explore its neighbours (guided visibility
// sampling, Wonka et al. 2006), which would take uniform rays a hundred times as long. Objects whose bounds meet the box are always
// visible.
//
// The whole batch that found nothing new is a certificate: were the missed share of uniform rays above 1e-4, it would have met nothing
// new with a probability below 1 %. Each batch is one such test of the set before it; a region has at most rays / 46,208 of them. The
// missed share itself is Good and Turing's estimate: the expected share of further uniform rays whose first hit is no member of the set,
// = objects that one uniform ray found and no independent ray confirms / uniform rays. What that ray's own exploration sees
// again counts as no confirmation. Measured, it was 0.6 to 1.6 times the true share (tests/bench/place.md).
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/work.h"
#include "render/visibility/raytracer.h"

namespace standin {

struct VisibilityOptions {
  std::uint64_t rays = 200'000;  // at most, per region, of all kinds
  std::uint64_t seed = 1;
};

struct VisibleSet {
  std::vector<std::uint32_t> objects;  // ascending
  double missed_ray_share = 0.0;       // estimate, 0..1; 1 without uniform rays
  bool certified = false;              // the last batch was whole and met nothing new
};

/// One set per region, independent of the number of threads.
[[nodiscard]] std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                                          const VisibilityOptions& options, int threads, const WorkBudget& budget);

/// Whether the scene has occlusion to gain: the mean share of triangles that is hidden from sampled regions, from a quick probe (65
/// thousand rays aimed at sampled objects, each hidden if every ray to it is stopped before its bounds). 0: none.
[[nodiscard]] double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed);

}  // namespace standin
