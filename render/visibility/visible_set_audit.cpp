#include "render/visibility/visible_set_audit.h"

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"
#include "render/visibility/certificate.h"
#include "render/visibility/region_rays.h"

namespace standin {
namespace {

// Streams of their own: none of the sampler's rays is shot again.
constexpr std::uint64_t kAuditSeed = 0x5DEECE66DULL;

struct RegionAudit {
  std::uint64_t misses = 0;
  double worst_view_share = 0.0;
};

class RegionAuditor {
 public:
  RegionAuditor(const Scene& scene, const Raytracer& raytracer, const Box& region, const VisibleSet& set, const Camera& camera,
                std::uint64_t seed, std::uint64_t stream)
      : raytracer_(raytracer),
        region_(region),
        camera_(camera),
        cap_(region, scene.bounds),
        is_member_(scene.objects.size(), false),
        rng_(seed ^ kAuditSeed, stream) {
    for (const std::uint32_t object : set.objects) is_member_[object] = true;
  }

  [[nodiscard]] std::uint64_t misses(std::uint64_t rays) {
    std::uint64_t count = 0;
    for (std::uint64_t i = 0; i < rays; ++i) {
      const Vec3 position = random_point(rng_, region_);
      if (misses_an_object(position, cap_.random_direction(rng_))) ++count;
    }
    return count;
  }

  /// Of the pixels of a random view.
  [[nodiscard]] double missed_share_of_view(std::uint32_t side) {
    const View view{random_point(rng_, region_), cap_.random_direction(rng_)};
    const Mat3 world_from_eye = world_from_eye_rotation(view.direction);
    std::uint32_t missed = 0;
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
      const double x = (2.0 * (pixel % side + rng_.uniform()) / side - 1.0) * camera_.tan_half_x();
      const double y = (2.0 * (pixel / side + rng_.uniform()) / side - 1.0) * camera_.tan_half_y();
      if (misses_an_object(view.position, glm::normalize(world_from_eye * Vec3(x, y, -1.0)))) ++missed;
    }
    return static_cast<double>(missed) / (static_cast<double>(side) * side);
  }

 private:
  [[nodiscard]] bool misses_an_object(const Vec3& position, const Vec3& direction) const {
    const auto hit = raytracer_.nearest(position, direction);
    return hit && !is_member_[hit->object];
  }

  const Raytracer& raytracer_;
  const Box& region_;
  const Camera& camera_;
  DirectionCap cap_;
  std::vector<bool> is_member_;
  Rng rng_;
};

}  // namespace

VisibilityAudit audit_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                   const std::vector<VisibleSet>& sets, const Camera& camera, const VisibilityAuditOptions& options,
                                   int threads, const WorkBudget& budget) {
  VisibilityAudit audit;
  if (regions.empty()) return audit;
  const std::uint64_t rays_each = (options.rays + regions.size() - 1) / regions.size();
  std::vector<RegionAudit> audits(regions.size());
  parallel_for(regions.size(), threads, budget, [&](std::size_t i) {
    RegionAuditor auditor(scene, raytracer, regions[i], sets[i], camera, options.seed, i);
    audits[i].misses = auditor.misses(rays_each);
    for (std::uint32_t view = 0; view < options.views; ++view)
      audits[i].worst_view_share = std::max(audits[i].worst_view_share, auditor.missed_share_of_view(options.rays_per_side));
  });
  double widest_cap = 0.0;
  for (const Box& region : regions) widest_cap = std::max(widest_cap, DirectionCap(region, scene.bounds).share_of_sphere());
  for (const RegionAudit& one : audits) {
    audit.misses += one.misses;
    audit.worst_view_share = std::max(audit.worst_view_share, one.worst_view_share);
    audit.mean_worst_share += one.worst_view_share / static_cast<double>(regions.size());
  }
  audit.rays = rays_each * regions.size();
  audit.views = std::uint64_t{options.views} * regions.size();
  audit.mean_missed_share_bound = widest_cap * clopper_pearson_upper(audit.misses, audit.rays, kVisibilityConfidence);
  return audit;
}

}  // namespace standin
