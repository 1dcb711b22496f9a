// Bakes what the selection chooses, once, and knows the real bytes and costs from then on (thesis 5.7.3 bakes at each greedy step).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "placement/candidates/candidates.h"
#include "render/impostor/impostor.h"
#include "render/impostor/texture_pyramid.h"
#include "server/job/bake_memory.h"
#include "server/job/world.h"

namespace standin {

/// What is known of a candidate once it is baked.
struct BakedSize {
  double bytes = 0.0;
  ImpostorCost cost;
  bool possible = true;
};

/// Keeps what was baked across rounds; candidates keep their ids throughout.
class Baker {
 public:
  /// `memory`: of bakes in the same world, looked at and added to; or none.
  Baker(const World& world, const std::vector<Candidate>& candidates, BakeMemory* memory);

  /// Bakes those of `chosen` that are not baked yet, side by side. Returns how many.
  std::uint32_t bake(const std::vector<std::uint32_t>& chosen, const WorkBudget& budget);

  [[nodiscard]] std::size_t count() const { return baked_.size(); }
  /// `candidate`: baked.
  [[nodiscard]] const Impostor& impostor(std::uint32_t candidate) const { return baked_.at(candidate); }
  [[nodiscard]] Impostor take(std::uint32_t candidate) { return std::move(baked_.at(candidate)); }

  /// Real bytes of what is baked, estimates of the rest.
  [[nodiscard]] double bytes(const std::vector<std::uint32_t>& chosen) const;
  /// Per candidate: real bytes and costs; nothing before it is baked.
  [[nodiscard]] const std::vector<std::optional<BakedSize>>& sizes() const { return sizes_; }

 private:
  [[nodiscard]] std::optional<Impostor> recall_or_bake(const Candidate& candidate, const BakeCandidate& bake) const;
  void keep(std::uint32_t id, std::optional<Impostor> impostor);

  const World& world_;
  const TexturePyramids textures_;
  const std::vector<Candidate>& candidates_;
  BakeMemory* memory_;
  std::vector<std::optional<BakedSize>> sizes_;
  std::map<std::uint32_t, Impostor> baked_;
};

}  // namespace standin
