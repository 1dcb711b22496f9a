#include "server/cache/visible_set_cache.h"

#include <atomic>
#include <numeric>

#include "render/base/parallel.h"
#include "server/cache/camera_content.h"
#include "server/cache/object_content.h"

namespace standin {
namespace {

Fingerprint what_blocks(const Scene& scene) {
  Fingerprinter to;
  to.add(scene.bounds).add_list(ray_contents(scene));
  std::vector<std::uint32_t> all(scene.objects.size());
  std::iota(all.begin(), all.end(), 0U);
  add_sharing(scene, all, to);  // instances are traced in their own space
  return to.fingerprint();
}

std::string bytes_of(const VisibleSet& set) {
  ByteWriter bytes;
  bytes.list(set.objects);
  bytes.value(set.missed_share_bound);
  bytes.value(set.rays);
  bytes.value(set.misses);
  return bytes.bytes();
}

VisibleSet read_set(ByteReader& bytes, std::size_t objects) {
  VisibleSet set;
  set.objects = bytes.list<std::uint32_t>();
  set.missed_share_bound = bytes.value<double>();
  set.rays = bytes.value<std::uint64_t>();
  set.misses = bytes.value<std::uint64_t>();
  for (const std::uint32_t object : set.objects)
    if (object >= objects) throw Failure(ErrorWord::kFileBroken, "a visible set names object " + std::to_string(object));
  return set;
}

std::string bytes_of(const VisibilityAudit& audit) {
  ByteWriter bytes;
  bytes.value(audit.mean_missed_share_bound);
  bytes.value(audit.rays);
  bytes.value(audit.misses);
  bytes.value(audit.views);
  bytes.value(audit.worst_view_share);
  bytes.value(audit.mean_worst_share);
  return bytes.bytes();
}

VisibilityAudit read_audit(ByteReader& bytes) {
  VisibilityAudit audit;
  audit.mean_missed_share_bound = bytes.value<double>();
  audit.rays = bytes.value<std::uint64_t>();
  audit.misses = bytes.value<std::uint64_t>();
  audit.views = bytes.value<std::uint64_t>();
  audit.worst_view_share = bytes.value<double>();
  audit.mean_worst_share = bytes.value<double>();
  return audit;
}

}  // namespace

VisibleSetCache::VisibleSetCache(StageCache* cache, const Scene& scene, const Raytracer& raytracer)
    : cache_(cache), scene_(scene), raytracer_(raytracer) {
  if (cache_ != nullptr) what_blocks_ = what_blocks(scene);
}

Fingerprint VisibleSetCache::inputs_of(const Box& region, const VisibilityOptions& options, std::uint64_t stream) const {
  Fingerprinter to;
  to.add(what_blocks_).add(region).add(stream);
  return to.add(options.rays).add(options.missed_share).add(options.seed).fingerprint();
}

VisibleSet VisibleSetCache::recall_or_sample(const Box& region, const VisibilityOptions& options, std::uint64_t stream,
                                             const WorkBudget& budget) const {
  if (cache_ == nullptr) return sample_visible_set(scene_, raytracer_, region, options, stream, budget);
  const Fingerprint inputs = inputs_of(region, options, stream);
  const auto read = [&](ByteReader& bytes) { return read_set(bytes, scene_.objects.size()); };
  if (auto known = cache_->recall(kVisibleSets, inputs, read)) return *std::move(known);
  VisibleSet set = sample_visible_set(scene_, raytracer_, region, options, stream, budget);
  cache_->keep(kVisibleSets, inputs, bytes_of(set));
  return set;
}

std::vector<VisibleSet> VisibleSetCache::sets(const std::vector<Box>& regions, const VisibilityOptions& options, int threads,
                                              const WorkBudget& budget) const {
  std::vector<VisibleSet> found(regions.size());
  std::atomic<std::size_t> done{0};
  parallel_for(regions.size(), threads, budget, [&](std::size_t i) {
    found[i] = recall_or_sample(regions[i], options, i, budget);
    budget.report("visibility", static_cast<double>(++done) / static_cast<double>(regions.size()));
  });
  return found;
}

VisibilityAudit VisibleSetCache::audit(const std::vector<Box>& regions, const std::vector<VisibleSet>& sets, const Camera& camera,
                                       const VisibilityAuditOptions& options, int threads, const WorkBudget& budget) const {
  const auto look = [&] { return audit_visible_sets(scene_, raytracer_, regions, sets, camera, options, threads, budget); };
  if (cache_ == nullptr) return look();
  Fingerprinter to;
  to.add(what_blocks_).add(options.rays).add(options.views).add(options.rays_per_side).add(options.seed);
  add_camera(camera, to);
  to.add(std::uint64_t{regions.size()});
  for (std::size_t i = 0; i < regions.size(); ++i) to.add(regions[i]).add_list(sets[i].objects);
  const Fingerprint inputs = to.fingerprint();
  if (const auto known = cache_->recall(kVisibilityAudits, inputs, read_audit)) return *known;
  const VisibilityAudit audit = look();
  cache_->keep(kVisibilityAudits, inputs, bytes_of(audit));
  return audit;
}

}  // namespace standin
