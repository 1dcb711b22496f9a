// A set S of candidates that solves CPVs, and how each of them is solved.
//
// Every tracked CPV has a current antichain of S. Once it meets its CPV it stays that way: a candidate may leave S only if all CPVs that
// use it have another antichain of what remains (found by AntichainFinder). CPVs that do not use the candidate need no look.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "placement/select/antichain.h"

namespace standin {

/// A CPV and the antichain it is to use.
struct Assignment {
  std::uint32_t cpv = 0;
  std::vector<Serving> antichain;  // by candidate id
};

class Cover {
 public:
  Cover(const SelectionProblem& problem, const TreeOrder& order);

  [[nodiscard]] bool contains(std::uint32_t candidate) const { return in_set_[candidate]; }
  [[nodiscard]] std::vector<std::uint32_t> members() const;
  [[nodiscard]] const std::vector<Serving>& antichain(std::uint32_t cpv) const { return antichain_[cpv]; }
  /// Best antichain of S at the CPV, whatever it uses now.
  [[nodiscard]] Antichain best(std::uint32_t cpv) { return finder_.best(serving_[cpv], cpv); }

  [[nodiscard]] bool uses(std::uint32_t cpv, std::uint32_t candidate) const;

  void add(std::uint32_t candidate);
  void assign(std::uint32_t cpv, std::vector<Serving> antichain) { antichain_[cpv] = std::move(antichain); }

  /// New antichains for all CPVs that use the candidate, without it; nothing if one of them cannot do without.
  [[nodiscard]] std::optional<std::vector<Assignment>> replacements(std::uint32_t candidate);
  /// The best antichains for all CPVs that use the candidate, without it, whether they meet their CPVs or not.
  [[nodiscard]] std::vector<Assignment> best_without(std::uint32_t candidate);
  /// Takes the candidate out and switches to its replacements; returns the assignments they replace (for put_back).
  std::vector<Assignment> remove(std::uint32_t candidate, std::vector<Assignment> replacements);
  /// Undoes the latest remove() of the candidate.
  void put_back(std::uint32_t candidate, std::vector<Assignment> previous);

 private:
  [[nodiscard]] bool before(const Serving& a, const Serving& b) const;

  const SelectionProblem& problem_;
  const TreeOrder& order_;
  AntichainFinder finder_;
  std::vector<bool> in_set_;
  std::vector<std::vector<Serving>> serving_;  // per CPV: members of S that serve it, by (rank, candidate id)
  std::vector<std::vector<Serving>> antichain_;
};

}  // namespace standin
