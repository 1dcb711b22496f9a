#include "server/job/baker.h"

#include <algorithm>
#include <atomic>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/impostor/atlas.h"
#include "render/impostor/technique.h"

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
  std::atomic<std::size_t> done{0};
  parallel_for(missing.size(), world_.threads, budget, [&](std::size_t i) {
    fresh[i] = recall_or_bake(candidates_[missing[i]], budget);
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

std::optional<Impostor> Baker::recall_or_bake(const Candidate& candidate, const WorkBudget& budget) const {
  if (memory_ != nullptr)
    if (auto known = memory_->recall(candidate)) return *std::move(known);
  auto impostor = try_bake(candidate, budget);
  if (memory_ != nullptr) memory_->keep(candidate, impostor);
  return impostor;
}

// Nothing where the sketch was too hopeful: the recorded vertices need more layers than allowed.
std::optional<Impostor> Baker::try_bake(const Candidate& candidate, const WorkBudget& budget) const {
  try {
    return bake_impostor(world_.scene, textures_, candidate.technique, {candidate.objects, candidate.view_cell}, world_.camera,
                         world_.quality, budget);
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kImpostorImpossible) throw;
    return std::nullopt;
  }
}

void Baker::keep(std::uint32_t id, std::optional<Impostor> impostor) {
  sizes_[id] = kImpossible;
  if (impostor) sizes_[id] = BakedSize{std::max(1.0, static_cast<double>(texture_bytes(*impostor))), impostor_cost(*impostor), true};
  baked_.emplace(id, impostor ? std::move(*impostor) : Impostor{});
}

}  // namespace standin
