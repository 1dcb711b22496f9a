// A second look at finished visible sets, by rays that had no part in them: the mean over all regions, and single views.
//
// A region's own certificate says little more than was asked for, since it stops there. Fresh rays, a few from each region, bound the mean
// over the regions ten times lower (Clopper and Pearson's bound of a sample of fixed size; nothing they find is added). And as a missed
// share of all views together may lie in one of them, some views of each region are cast in full: the share of a view's pixels that would
// show something else.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/work.h"
#include "render/view/camera.h"
#include "render/visibility/visible_set.h"

namespace standin {

struct VisibilityAuditOptions {
  std::uint64_t rays = 460'517;      // uniform ones, of all regions together, at least one each: ln 0.01 / ln(1 - 1e-5)
  std::uint32_t views = 4;           // per region, uniform in position and direction
  std::uint32_t rays_per_side = 24;  // of a view's raster
  std::uint64_t seed = 1;
};

struct VisibilityAudit {
  double mean_missed_share_bound = 1.0;  // of the mean over the regions of their missed share, at 99 %
  std::uint64_t rays = 0;                // uniform ones
  std::uint64_t misses = 0;
  std::uint64_t views = 0;
  double worst_view_share = 0.0;  // of pixels that miss an object, in the worst sampled view of all regions, 0..1
  double mean_worst_share = 0.0;  // likewise, mean over the regions of each one's worst view
};

/// `sets[i]` belongs to `regions[i]`; independent of the number of threads.
[[nodiscard]] VisibilityAudit audit_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                                 const std::vector<VisibleSet>& sets, const Camera& camera,
                                                 const VisibilityAuditOptions& options, int threads, const WorkBudget& budget);

}  // namespace standin
