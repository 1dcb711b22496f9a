// Whether visible sets can pay for themselves in a scene, from a quick look: 65 thousand rays instead of some 100 thousand per region.
#pragma once

#include <cstdint>
#include <vector>

#include "render/visibility/raytracer.h"

namespace standin {

/// Whether the scene has occlusion to gain: the mean share of triangles that is hidden from sampled regions (rays aimed at sampled
/// objects, each object hidden if every ray to it is stopped before its bounds). 0: none.
[[nodiscard]] double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed);

}  // namespace standin
