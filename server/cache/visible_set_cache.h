// Visible sets (render/visibility) that are looked up before they are sampled, one entry for each 3D leaf, and their audit, one for all.
//
// Any triangle of the scene may block a leaf's rays, and rays are aimed at every object, so a set depends on the triangles and masks of the
// whole scene: an edit of geometry anywhere asks for all sets anew, one of colours or of a texture's pixels (but for masks) for none. That
// a material gets or loses a texture counts as geometry (add_sharing).
#pragma once

#include "render/visibility/visible_set.h"
#include "render/visibility/visible_set_audit.h"
#include "server/cache/stage_cache.h"

namespace standin {

inline constexpr CacheStage kVisibleSets{"visible_sets"};
inline constexpr CacheStage kVisibilityAudits{"visibility_audits"};

/// As sample_visible_sets() and audit_visible_sets(); without `cache` these. The scene must outlive it.
class VisibleSetCache {
 public:
  VisibleSetCache(StageCache* cache, const Scene& scene, const Raytracer& raytracer);

  [[nodiscard]] std::vector<VisibleSet> sets(const std::vector<Box>& regions, const VisibilityOptions& options, int threads,
                                             const WorkBudget& budget) const;
  [[nodiscard]] VisibilityAudit audit(const std::vector<Box>& regions, const std::vector<VisibleSet>& sets, const Camera& camera,
                                      const VisibilityAuditOptions& options, int threads, const WorkBudget& budget) const;

  /// What region number `stream` depends on.
  [[nodiscard]] Fingerprint inputs_of(const Box& region, const VisibilityOptions& options, std::uint64_t stream) const;

 private:
  [[nodiscard]] VisibleSet recall_or_sample(const Box& region, const VisibilityOptions& options, std::uint64_t stream,
                                            const WorkBudget& budget) const;

  StageCache* cache_;
  const Scene& scene_;
  const Raytracer& raytracer_;
  Fingerprint what_blocks_;  // triangles and masks of all objects, in order: entries hold objects by number
};

}  // namespace standin
