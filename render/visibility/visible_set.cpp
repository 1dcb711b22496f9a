#include "render/visibility/visible_set.h"

#include <algorithm>
#include <atomic>

#include "render/base/parallel.h"
#include "render/base/rng.h"
#include "render/visibility/aimed_search.h"
#include "render/visibility/certificate.h"
#include "render/visibility/region_rays.h"

namespace standin {
namespace {

constexpr double kBuildingRays = 0.3;          // uniform ones, over the missed share asked for: a sixteenth of what certifies it
constexpr double kLeastCapShare = 1.0 / 16.0;  // a scene that covers less of the sphere is looked at as closely as this share of it
constexpr std::uint64_t kRaysPerCheck = 1024;
constexpr std::uint64_t kRaysPerBound = 64;  // the bound is worth a ray itself

class RegionSampler {
 public:
  RegionSampler(const Scene& scene, const Raytracer& raytracer, const Box& region, const VisibilityOptions& options, std::uint64_t stream,
                const WorkBudget& budget)
      : raytracer_(raytracer),
        region_(region),
        cap_(region, scene.bounds),
        missed_share_of_cap_(std::min(0.5, options.missed_share / std::max(cap_.share_of_sphere(), kLeastCapShare))),
        rays_(options.rays),
        budget_(budget),
        building_(options.seed, 2 * stream),
        certifying_(options.seed, 2 * stream + 1),
        search_(scene, raytracer, region, options.rays, building_, budget) {}

  VisibleSet sample() {
    build();
    const MissCertificate certificate = certify();
    return {search_.seen(), cap_.share_of_sphere() * certificate.upper_bound(), rays_ - search_.rays_left(), certificate.misses()};
  }

 private:
  void build() {
    const auto rays = std::min(static_cast<std::uint64_t>(kBuildingRays / missed_share_of_cap_), search_.rays_left() / 4);
    for (std::uint64_t i = 0; i < rays; ++i) shoot_uniform(building_, i);
    search_.aim();
  }

  MissCertificate certify() {
    MissCertificate certificate(kVisibilityConfidence, missed_share_of_cap_);
    for (std::uint64_t i = 0; search_.rays_left() > 0; ++i) {
      if (i % kRaysPerBound == 0 && certificate.upper_bound() <= missed_share_of_cap_) break;
      if (certificate.add(shoot_uniform(certifying_, i))) search_.aim();
    }
    return certificate;
  }

  // Returns whether it saw something new.
  bool shoot_uniform(Rng& rng, std::uint64_t ordinal) {
    if (ordinal % kRaysPerCheck == 0) budget_.check();
    static_cast<void>(search_.spend());
    const Vec3 position = random_point(rng, region_);
    const auto hit = raytracer_.nearest(position, cap_.random_direction(rng));
    return hit && search_.add(hit->object, position);
  }

  const Raytracer& raytracer_;
  const Box& region_;
  DirectionCap cap_;
  double missed_share_of_cap_;  // to be certified
  std::uint64_t rays_;
  const WorkBudget& budget_;
  Rng building_;
  Rng certifying_;  // its rays depend on nothing that built the set
  AimedSearch search_;
};

}  // namespace

VisibleSet sample_visible_set(const Scene& scene, const Raytracer& raytracer, const Box& region, const VisibilityOptions& options,
                              std::uint64_t stream, const WorkBudget& budget) {
  if (scene.objects.empty()) return {};
  return RegionSampler(scene, raytracer, region, options, stream, budget).sample();
}

std::vector<VisibleSet> sample_visible_sets(const std::vector<Box>& regions, int threads, const WorkBudget& budget,
                                            const SampleRegion& sample) {
  std::vector<VisibleSet> sets(regions.size());
  std::atomic<std::size_t> done{0};
  parallel_for(regions.size(), threads, budget, [&](std::size_t i) {
    sets[i] = sample(regions[i], i);
    budget.report("visibility", static_cast<double>(++done) / static_cast<double>(regions.size()));
  });
  return sets;
}

std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                            const VisibilityOptions& options, int threads, const WorkBudget& budget) {
  return sample_visible_sets(regions, threads, budget, [&](const Box& region, std::uint64_t stream) {
    return sample_visible_set(scene, raytracer, region, options, stream, budget);
  });
}

}  // namespace standin
