#include "server/job/fit_sizes.h"

#include <limits>

#include "render/impostor/texture_pyramid.h"
#include "server/cache/bake_cache.h"

namespace standin {
namespace {

// Meshes are sampled where a layered impostor is a candidate as well, if those are offered: the others are large, slow to bake and hardly
// ever chosen.
void keep_samples(Technique technique, bool beside_layers, std::vector<Candidate>& candidates) {
  std::vector<Candidate> kept;
  const Candidate* layered = nullptr;  // of the cluster and cells at hand: it comes first
  for (const Candidate& candidate : candidates) {
    if (candidate.technique == Technique::kLayered) layered = &candidate;
    const bool has_layered = layered != nullptr && layered->node == candidate.node && layered->cells == candidate.cells;
    if (candidate.technique == technique && (!beside_layers || !is_mesh(technique) || has_layered)) kept.push_back(candidate);
  }
  candidates = std::move(kept);
}

// From real bakes of the technique's own candidates. Of what else is offered, layered impostors alone decide which those are: so the law of
// one technique is the same whatever stands beside it.
SizeModel fit_sizes(const Surveyed& job, const Subdivision& probe, Technique technique, const JobSpec& spec, const WorkBudget& budget) {
  const World& world = job.world;
  SizeModels sizes;
  for (const Technique offered : techniques_of(spec))
    if (offered == technique || offered == Technique::kLayered) sizes.offer(offered, default_size_model(offered));
  CandidateSet set = generate_candidates(world.scene, world.hierarchy, probe, job.target.model, sizes, world.camera, world.quality,
                                         job.candidate_options, budget);
  keep_samples(technique, sizes.offers(Technique::kLayered), set.candidates);
  if (set.candidates.empty()) return default_size_model(technique);
  const TexturePyramids textures(world.scene);
  const BakeCandidate bake =
      through_cache(world.bake_cache.get(), candidate_baker(world.scene, textures, world.camera, world.quality, budget));
  return fit_size_model(world.scene, set.candidates, world.camera, world.quality, spec.size_bakes, spec.seed, world.threads, budget, bake);
}

}  // namespace

// The slow regions of some cells, enough for typical candidates. They do not depend on a budget, so that all budgets share the models.
Subdivision probe_views(const Surveyed& job, const WorkBudget& budget) {
  constexpr std::size_t kProbedLeaves = 256;
  constexpr double kProbeShare = 0.6;
  const std::vector<CellKey> all = leaf_keys(job.world.view_space);
  const std::size_t stride = (all.size() + kProbedLeaves - 1) / kProbedLeaves;
  std::vector<CellKey> leaves;
  for (std::size_t i = 0; i < all.size(); i += stride) leaves.push_back(all[i]);
  const double worst_ms = problem_views(job, std::numeric_limits<double>::infinity(), budget, leaves).worst_predicted_ms;
  return problem_views(job, kProbeShare * worst_ms, budget, std::move(leaves));
}

SizeModels fit_sizes(const Surveyed& job, const JobSpec& spec, const WorkBudget& budget) {
  SizeModels sizes;
  for (const Technique technique : techniques_of(spec)) sizes.offer(technique, default_size_model(technique));
  if (spec.size_bakes == 0) return sizes;
  const Subdivision probe = probe_views(job, budget);
  for (const Technique technique : techniques_of(spec)) sizes.offer(technique, fit_sizes(job, probe, technique, spec, budget));
  return sizes;
}

}  // namespace standin
