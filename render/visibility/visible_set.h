// From-region visibility with a certificate: which objects can be seen from a box of positions, and how much a view from it misses.
//
// Some uniform rays, then rays aimed at what they did not see, build the set (aimed_search.h). Then fresh uniform rays test it until they
// have proved that the missed share is at most the one asked for, at 99 %, or the region's rays are used up. What they see beyond the set
// is added at once; the proof allows for that (certificate.h). The bound is the set's as returned: other independent rays may only lower
// it.
//
// The missed share is that of rays from uniform positions of the box in uniform directions whose first hit is no member of the set: of
// the pixels of all views together, weighted by solid angle. A single view can miss more (visible_set_audit.h samples how much). Objects
// whose bounds meet the box are always visible.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/base/work.h"
#include "render/visibility/raytracer.h"

namespace standin {

/// The chance that a stated bound on a missed share holds.
constexpr double kVisibilityConfidence = 0.99;

struct VisibilityOptions {
  std::uint64_t rays = 1'000'000;  // at most, per region, of all kinds
  double missed_share = 1e-4;      // to be certified, of uniform rays, in (0, 1)
  std::uint64_t seed = 1;
};

struct VisibleSet {
  std::vector<std::uint32_t> objects;  // ascending
  double missed_share_bound = 1.0;     // upper bound at 99 %, 0..1; 1 without uniform rays
  std::uint64_t rays = 0;              // shot, of all kinds
  std::uint64_t misses = 0;            // certifying rays that saw something new
};

/// Of one region, whose rays are those of `stream` (its number): a task of its own, which needs no other region.
[[nodiscard]] VisibleSet sample_visible_set(const Scene& scene, const Raytracer& raytracer, const Box& region,
                                            const VisibilityOptions& options, std::uint64_t stream, const WorkBudget& budget);

/// One set per region, independent of the number of threads.
/// Of region number `stream`.
using SampleRegion = std::function<VisibleSet(const Box& region, std::uint64_t stream)>;
[[nodiscard]] std::vector<VisibleSet> sample_visible_sets(const std::vector<Box>& regions, int threads, const WorkBudget& budget,
                                                          const SampleRegion& sample);
[[nodiscard]] std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                                          const VisibilityOptions& options, int threads, const WorkBudget& budget);

}  // namespace standin
