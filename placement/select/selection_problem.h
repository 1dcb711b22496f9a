// Impostor selection.
//
// Given candidates c = 0..C-1, each standing for a node of the object tree, and over-budget regions (CPVs) p = 0..P-1 with K stages each
// (an additive time model has K = 1), choose a set S and for every p an antichain A_p of { c in S : p served by c } (no node inside
// another), so as to
//     minimise    sum over c in S of bytes[c]
//     subject to  sum over c in A_p of gain[c,p,k]  >=  deficit[p,k]      for every p and k
// gain is measured against the ORIGINAL objects (thesis Eq. 5.4 without its truncation), so antichain gains add exactly. It is sparse, in
// rows by candidate with a sentinel at the end: rows 0, 1 with gains {(p2, 1.5)}, {} are
//     offset = 0 1 1    cpv = 2    gain = 1.5          (gain holds K values per entry)
// Thesis 5.3-5.7, math.md 5. Set cover in disguise, hence NP-hard; the greedy is Wolsey's truncated sum, computed so that it is monotone
// under rounding. The solver never sees geometry.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/base/work.h"

namespace standin {

struct SelectionProblem {
  std::uint32_t stages = 1;           // K
  std::vector<std::int32_t> parent;   // tree of nodes; parent[n] < n or -1
  std::vector<std::uint32_t> node;    // per candidate
  std::vector<double> bytes;          // per candidate, > 0
  std::vector<double> deficit;        // P * K, may be <= 0 (already met)
  std::vector<std::uint64_t> offset;  // C + 1
  std::vector<std::uint32_t> cpv;     // per entry, ascending within a row
  std::vector<double> gain;           // per entry * K

  [[nodiscard]] std::uint32_t candidate_count() const { return static_cast<std::uint32_t>(node.size()); }
  [[nodiscard]] std::uint32_t cpv_count() const { return static_cast<std::uint32_t>(deficit.size() / stages); }
};

/// Why a CPV stayed unsolved.
struct Shortfall {
  std::uint32_t cpv = 0;
  double residual = 0.0;  // what is missing with the best antichain over ALL candidates (math.md 5.4)
};

struct SelectionSummary {
  enum class Stop { kAllMet, kSomeUnreachable } stop = Stop::kAllMet;
  std::string message;
  double bytes_greedy = 0.0;       // after greedy and stall repair
  double bytes = 0.0;              // after reverse-delete and exchange
  double lower_bound_bytes = 0.0;  // Lagrangian (math.md 5.5), of the instance without its unreachable CPVs
  std::uint32_t picked_by_greedy = 0;
  std::uint32_t stalled = 0;      // CPVs that the stall repair had to solve
  std::uint64_t evaluations = 0;  // score evaluations
  std::vector<Shortfall> unmet;   // empty iff kAllMet
};

struct Selection {
  std::vector<std::uint32_t> chosen;                 // ascending candidate ids
  std::vector<std::vector<std::uint32_t>> assigned;  // per CPV: its antichain, ascending candidate ids
  SelectionSummary summary;
};

struct SelectionConfig {
  bool lazy = true;            // false: plain greedy, the oracle
  int exchange_rounds = 0;     // 0: reverse-delete only; each round tries to add one and delete others
  int bound_iterations = 100;  // subgradient steps; 0: no lower bound
};

/// `initial`: candidates that are already in S (a repair after baking); greedy goes on from there. Deterministic: ties by score, then lower
/// id.
[[nodiscard]] Selection select_impostors(const SelectionProblem& problem, const SelectionConfig& config,
                                         std::span<const std::uint32_t> initial, const WorkBudget& budget);

/// Lower bound on the bytes of any selection that meets every reachable CPV (math.md 5.5), from `iterations` subgradient steps.
/// `known_bytes`: of a known selection.
[[nodiscard]] double memory_lower_bound(const SelectionProblem& problem, double known_bytes, int iterations, const WorkBudget& budget);

}  // namespace standin
