#include "server/job/baker.h"

#include <algorithm>
#include <atomic>

#include "render/base/parallel.h"
#include "render/impostor/atlas.h"
#include "server/cache/bake_cache.h"

namespace standin {
namespace {

// What cannot be baked takes no memory and costs more time than any region has: the next round lets go of it.
constexpr BakedSize kImpossible{0.0, {1e15, 1e15, 1.0}, false};

}  // namespace

Baker::Baker(const World& world, const std::vector<Candidate>& candidates, BakeMemory* memory)
    : world_(world), textures_(world.scene), candidates_(candidates), memory_(memory), sizes_(candidates.size()) {}

std::uint32_t Baker::bake(const std::vector<std::uint32_t>& chosen, const WorkBudget& budget) {
  std::vector<std::uint32_t> missing;
  for (const auto id : chosen)
    if (!baked_.contains(id)) missing.push_back(id);
  std::vector<std::optional<Impostor>> fresh(missing.size());
  const BakeCandidate bake =
      through_cache(world_.bake_cache.get(), candidate_baker(world_.scene, textures_, world_.camera, world_.quality, budget));
  std::atomic<std::size_t> done{0};
  parallel_for(missing.size(), world_.threads, budget, [&](std::size_t i) {
    fresh[i] = recall_or_bake(candidates_[missing[i]], bake);
    budget.report("bake", static_cast<double>(++done) / static_cast<double>(missing.size()));
  });
  for (std::size_t i = 0; i < missing.size(); ++i) keep(missing[i], std::move(fresh[i]));
  return static_cast<std::uint32_t>(missing.size());
}

double Baker::bytes(const std::vector<std::uint32_t>& chosen) const {
  double sum = 0.0;
  for (const auto id : chosen) sum += sizes_[id] ? sizes_[id]->bytes : candidates_[id].bytes;
  return sum;
}

std::optional<Impostor> Baker::recall_or_bake(const Candidate& candidate, const BakeCandidate& bake) const {
  if (memory_ != nullptr)
    if (auto known = memory_->recall(candidate)) return *std::move(known);
  auto impostor = bake(candidate);
  if (memory_ != nullptr) memory_->keep(candidate, impostor);
  return impostor;
}

void Baker::keep(std::uint32_t id, std::optional<Impostor> impostor) {
  sizes_[id] = kImpossible;
  if (impostor) sizes_[id] = BakedSize{std::max(1.0, static_cast<double>(texture_bytes(*impostor))), impostor_cost(*impostor), true};
  baked_.emplace(id, impostor ? std::move(*impostor) : Impostor{});
}

}  // namespace standin
