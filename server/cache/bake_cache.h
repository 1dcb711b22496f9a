// Baked impostors that outlive the job, one entry for each bake: those of the placement and those that the size models are fitted to.
//
// A bake looks at the triangles, materials and textures of its own objects, its view cell, the camera and the quality, and at nothing else
// of the scene (the thesis' bakes, chapter 3): whatever is edited elsewhere, it stays. That there can be no such impostor is an entry, too.
#pragma once

#include <vector>

#include "placement/candidates/candidates.h"
#include "server/cache/stage_cache.h"

namespace standin {

inline constexpr CacheStage kBakes{"bakes"};

/// The scene must outlive it. May be used from several threads.
class BakeCache {
 public:
  BakeCache(StageCache& cache, const Scene& scene, const Camera& camera, const BakeQuality& quality);

  /// What `bake` makes of a candidate, made or remembered.
  [[nodiscard]] std::optional<Impostor> recall_or_bake(const Candidate& candidate, const BakeCandidate& bake) const;
  [[nodiscard]] Fingerprint inputs_of(const Candidate& candidate) const;

 private:
  StageCache& cache_;
  const Scene& scene_;
  Fingerprint shared_;                 // camera and quality
  std::vector<Fingerprint> contents_;  // per object
};

/// As `bake`, but for what `cache` remembers; `bake` itself where there is no cache.
[[nodiscard]] BakeCandidate through_cache(const BakeCache* cache, BakeCandidate bake);

}  // namespace standin
