// What an impostor will weigh, from its sketch (thesis 5.8.1: texture resolution and number of layers).
//
// What is recorded is, per object, a rectangle of texels that the layers it reaches through cut into pieces, each with a gutter about it.
// So the paper's two variables count what is there: texels of the objects' own rectangles rather than of the whole texture, and layers
// that an object crosses rather than all of them. For clusters of one object in one layer bytes are the rectangle, exactly. A third
// variable says how much surface there is to cut.
#pragma once

#include <optional>
#include <span>

#include "placement/candidates/candidates.h"
#include "placement/candidates/outlines.h"

namespace standin {

/// The variables of the size model, all >= 1 but the last.
struct SizeInput {
  double silhouette_texels = 1.0;  // S: the objects' rectangles, together at most the whole texture
  double block_texels = 9.0;       // S': the same with gutters, as bytes count them
  double layers = 1.0;             // N
  double layers_crossed = 1.0;     // n: by an object, the mean over S
  double cut_texels = 0.0;         // C: what the borders between layers cut of all surfaces, one texel wide
};
/// `sketch`: of the objects' outlines, possible.
[[nodiscard]] SizeInput size_input(const Scene& scene, const ObjectOutlines& outlines, std::span<const std::uint32_t> objects,
                                   const ImpostorSketch& sketch);

struct SizeEstimate {
  double bytes = 0.0;   // of texture, gutters included
  double texels = 0.0;  // drawn: without gutters
  double quads = 0.0;
};
[[nodiscard]] SizeEstimate estimate_size(const SizeModel& model, const SizeInput& input);

/// One bake: what was known before and what came out.
struct SizeSample {
  SizeInput input;
  SizeEstimate baked;  // all > 0
};
/// Least absolute deviations in log space, slopes drawn weakly to those of the prior: any samples will do, also one, or all alike.
/// median_error is leave-one-out. The prior without samples.
[[nodiscard]] SizeModel fit_sizes(std::span<const SizeSample> samples, const SizeModel& prior = default_size_model());

/// One candidate from each of `count` equal strata by estimated bytes.
[[nodiscard]] std::vector<std::uint32_t> spread_of_candidates(const std::vector<Candidate>& candidates, std::uint32_t count,
                                                              std::uint64_t seed);
/// Nothing where the sketch was too hopeful, or where the bake shows nothing.
[[nodiscard]] std::optional<SizeSample> bake_size_sample(const Scene& scene, const ObjectOutlines& outlines, const Candidate& candidate,
                                                         const Camera& camera, const BakeQuality& quality, const BakeCandidate& bake);

}  // namespace standin
