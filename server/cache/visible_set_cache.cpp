#include "server/cache/visible_set_cache.h"

#include <numeric>

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

template <class Bytes, class Set>
void pass_set(Bytes& bytes, Set& set) {
  bytes.pass(set.objects);
  bytes.pass(set.missed_share_bound);
  bytes.pass(set.rays);
  bytes.pass(set.misses);
}

VisibleSet read_set(ByteReader& bytes, std::size_t objects) {
  VisibleSet set;
  pass_set(bytes, set);
  for (const std::uint32_t object : set.objects)
    if (object >= objects) throw Failure(ErrorWord::kFileBroken, "a visible set names object " + std::to_string(object));
  return set;
}

template <class Bytes, class Audit>
void pass_audit(Bytes& bytes, Audit& audit) {
  bytes.pass(audit.mean_missed_share_bound);
  bytes.pass(audit.rays);
  bytes.pass(audit.misses);
  bytes.pass(audit.views);
  bytes.pass(audit.worst_view_share);
  bytes.pass(audit.mean_worst_share);
}

VisibilityAudit read_audit(ByteReader& bytes) {
  VisibilityAudit audit;
  pass_audit(bytes, audit);
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
  ByteWriter bytes;
  pass_set(bytes, set);
  cache_->keep(kVisibleSets, inputs, bytes.bytes());
  return set;
}

std::vector<VisibleSet> VisibleSetCache::sets(const std::vector<Box>& regions, const VisibilityOptions& options, int threads,
                                              const WorkBudget& budget) const {
  return sample_visible_sets(regions, threads, budget,
                             [&](const Box& region, std::uint64_t stream) { return recall_or_sample(region, options, stream, budget); });
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
  ByteWriter bytes;
  pass_audit(bytes, audit);
  cache_->keep(kVisibilityAudits, inputs, bytes.bytes());
  return audit;
}

}  // namespace standin
