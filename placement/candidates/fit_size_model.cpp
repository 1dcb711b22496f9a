// A size model from real bakes of the scene at hand: the estimator moves results 10x, so it is calibrated before anything is tuned
// (simulation.md 8.10).
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "placement/candidates/size_model.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/rng.h"
#include "render/impostor/atlas.h"
#include "render/impostor/technique.h"
#include "render/scene/object_bounds.h"

namespace standin {

std::vector<std::uint32_t> spread_of_candidates(const std::vector<Candidate>& candidates, std::uint32_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> by_bytes(candidates.size());
  std::iota(by_bytes.begin(), by_bytes.end(), 0U);
  std::stable_sort(by_bytes.begin(), by_bytes.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return candidates[a].bytes < candidates[b].bytes; });
  Rng rng(seed);
  std::vector<std::uint32_t> chosen;
  const std::size_t strata = std::min<std::size_t>(count, candidates.size());
  for (std::size_t i = 0; i < strata; ++i) {
    const std::size_t begin = i * candidates.size() / strata;
    const std::size_t end = (i + 1) * candidates.size() / strata;
    chosen.push_back(by_bytes[begin + rng.below(end - begin)]);
  }
  return chosen;
}

BakeCandidate candidate_baker(const Scene& scene, const TexturePyramids& textures, const Camera& camera, const BakeQuality& quality,
                              const WorkBudget& budget) {
  return [&](const Candidate& candidate) -> std::optional<Impostor> {
    try {
      return bake_impostor(scene, textures, candidate.technique, {candidate.objects, candidate.view_cell}, camera, quality, budget);
    } catch (const Failure& failure) {
      if (failure.word() != ErrorWord::kImpostorImpossible) throw;
      return std::nullopt;
    }
  };
}

std::optional<SizeSample> bake_size_sample(const Scene& scene, const ObjectOutlines& outlines, const Candidate& candidate,
                                           const Camera& camera, const BakeQuality& quality, const BakeCandidate& bake) {
  const Box bounds = bounds_of(scene, candidate.objects);
  const ImpostorSketch sketch = sketch_impostor(bounds, outlines.of(candidate.objects), candidate.view_cell, camera, quality);
  if (!std::isfinite(sketch.layers)) return std::nullopt;
  const std::optional<Impostor> impostor = bake(candidate);
  if (!impostor || impostor->empty()) return std::nullopt;
  const ImpostorCost cost = impostor_cost(*impostor);
  return SizeSample{size_input(scene, outlines, candidate.objects, sketch),
                    {static_cast<double>(texture_bytes(*impostor)), cost.texels, cost.quads}};
}

SizeModel fit_size_model(const Scene& scene, const std::vector<Candidate>& candidates, const Camera& camera, const BakeQuality& quality,
                         std::uint32_t count, std::uint64_t seed, int threads, const WorkBudget& budget, const BakeCandidate& bake) {
  const auto chosen = spread_of_candidates(candidates, count, seed);
  const ObjectOutlines outlines(scene);
  std::vector<std::optional<SizeSample>> baked(chosen.size());
  parallel_for(chosen.size(), threads, budget,
               [&](std::size_t i) { baked[i] = bake_size_sample(scene, outlines, candidates[chosen[i]], camera, quality, bake); });
  std::vector<SizeSample> samples;
  for (const auto& sample : baked)
    if (sample) samples.push_back(*sample);
  return fit_sizes(samples, default_size_model(candidates.empty() ? Technique::kLayered : candidates.front().technique));
}

}  // namespace standin
