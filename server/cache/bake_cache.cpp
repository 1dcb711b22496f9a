#include "server/cache/bake_cache.h"

#include <utility>

#include "server/cache/camera_content.h"
#include "server/cache/impostor_bytes.h"
#include "server/cache/object_content.h"

namespace standin {
namespace {

Fingerprint shared_inputs(const Camera& camera, const BakeQuality& quality) {
  Fingerprinter to;
  add_camera(camera, to);
  to.add(quality.alpha_scale).add(quality.texel_scale).add(quality.max_layers).add(quality.max_resolution).add(quality.grid_texels);
  to.add(quality.fill_ratio).add(quality.fuzzy).add(quality.strict).add(quality.leave_out).add(quality.supercover).add(quality.seal_rims);
  return to.fingerprint();
}

void add_view_cell(const ViewCell& cell, Fingerprinter& to) {
  to.add(std::uint64_t{cell.index()});
  if (const auto* shaft = std::get_if<Shaft>(&cell))
    to.add(shaft->apex).add(shaft->axis).add(shaft->right).add(shaft->up).add(shaft->tan_half).add(shaft->min_distance_m);
  else
    to.add(std::get<Box>(cell));
}

}  // namespace

BakeCache::BakeCache(StageCache& cache, const Scene& scene, const Camera& camera, const BakeQuality& quality)
    : cache_(cache), scene_(scene), shared_(shared_inputs(camera, quality)), contents_(look_contents(scene)) {}

Fingerprint BakeCache::inputs_of(const Candidate& candidate) const {
  Fingerprinter to;
  to.add(shared_).add(candidate.technique);
  add_view_cell(candidate.view_cell, to);
  to.add(std::uint64_t{candidate.objects.size()});
  for (const std::uint32_t object : candidate.objects) to.add(contents_[object]);
  add_sharing(scene_, candidate.objects, to);
  return to.fingerprint();
}

std::optional<Impostor> BakeCache::recall_or_bake(const Candidate& candidate, const BakeCandidate& bake) const {
  const Fingerprint inputs = inputs_of(candidate);
  if (auto known = cache_.recall(kBakes, inputs, read_impostor)) {
    std::optional<Impostor> impostor = *std::move(known);
    if (!impostor) return impostor;
    impostor->objects = candidate.objects;
    impostor->view_cell = candidate.view_cell;
    return impostor;
  }
  auto impostor = bake(candidate);
  cache_.keep(kBakes, inputs, bytes_of(impostor));
  return impostor;
}

BakeCandidate through_cache(const BakeCache* cache, BakeCandidate bake) {
  if (cache == nullptr) return bake;
  return [cache, bake = std::move(bake)](const Candidate& candidate) { return cache->recall_or_bake(candidate, bake); };
}

}  // namespace standin
