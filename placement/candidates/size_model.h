// What an impostor will weigh, from its sketch (thesis 5.8.1: texture resolution and number of layers).
#pragma once

#include <span>

#include "placement/candidates/candidates.h"

namespace standin {

/// The two variables of the size model.
struct SizeInput {
  double silhouette_texels = 1.0;  // S >= 1: of all objects' boxes as seen from the reference viewpoint, at most the whole texture
  double layers = 1.0;             // N >= 1
};
[[nodiscard]] SizeInput size_input(const Scene& scene, std::span<const std::uint32_t> objects, const Box& object_bounds,
                                   const ViewCell& cell, const ImpostorSketch& sketch);

struct SizeEstimate {
  double bytes = 0.0;
  double quads = 0.0;
};
[[nodiscard]] SizeEstimate estimate_size(const SizeModel& model, const SizeInput& input);

/// One bake: what was known before and what came out.
struct SizeSample {
  SizeInput input;
  SizeEstimate baked;  // both > 0
};
/// Least squares in log space, slopes drawn weakly to those of default_size_model() (all samples may have one layer). median_error is
/// leave-one-out. The default model without samples.
[[nodiscard]] SizeModel fit_sizes(std::span<const SizeSample> samples);

}  // namespace standin
