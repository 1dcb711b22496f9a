// Impostor selection.
//
// Given candidates c = 0..C-1, each standing for a node of the object tree, and over-budget regions (CPVs) p = 0..P-1 with K stages each
// (an additive time model has K = 1), choose a set S and for every p an antichain A_p of { c in S : p served by c } (no node inside
// another), so as to
//     minimise    sum over c in S of bytes[c]
//     subject to  sum over c in A_p of gain[c,p,k]  >=  deficit[p,k]      for every p and k
// gain is measured against the ORIGINAL objects (thesis Eq. 5.4 without its truncation), so antichain gains add exactly. A city has
// thousands of millions of them, but they factor:
//     gain[c,p,k] = worth[node(c),p,k] - cost[c,form(p),k]
// worth: of the node's originals, the same for all its candidates; cost: of drawing the impostor, in one of the few linear forms that
// regions come in. Candidates serve whole view cells, so worth is stored in blocks, one per (node, cell), and a candidate lists runs of
// them. It serves p when p is in one of its blocks and some stage gains.
// Thesis 5.3-5.7, math.md 5. Set cover in disguise, hence NP-hard; the greedy is Wolsey's truncated sum, computed so that it is monotone
// under rounding. The solver never sees geometry.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "render/base/work.h"

namespace standin {

/// Half-open range of blocks.
struct BlockRun {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

struct SelectionProblem {
  std::uint32_t stages = 1;          // K
  std::uint32_t forms = 1;           // F
  std::vector<std::int32_t> parent;  // tree of nodes; parent[n] < n or -1

  std::vector<double> deficit;     // P * K, may be <= 0 (already met)
  std::vector<std::uint8_t> form;  // P, < F

  std::vector<std::uint32_t> block_offset = {0};  // blocks + 1, into the entries
  std::vector<std::uint32_t> cpv;                 // per entry, ascending within a block
  std::vector<double> worth;                      // per entry * K

  std::vector<std::uint32_t> node;              // per candidate
  std::vector<double> bytes;                    // per candidate, > 0
  std::vector<double> cost;                     // C * F * K
  std::vector<std::uint64_t> run_offset = {0};  // C + 1, into the runs
  std::vector<BlockRun> runs;                   // no CPV twice in a candidate; all candidates of a block have the same node

  [[nodiscard]] std::uint32_t candidate_count() const { return static_cast<std::uint32_t>(node.size()); }
  [[nodiscard]] std::uint32_t cpv_count() const { return static_cast<std::uint32_t>(form.size()); }
  [[nodiscard]] std::uint32_t block_count() const { return static_cast<std::uint32_t>(block_offset.size() - 1); }

  [[nodiscard]] std::span<const BlockRun> runs_of(std::uint32_t candidate) const {
    return {runs.data() + run_offset[candidate], runs.data() + run_offset[candidate + 1]};
  }
  /// The candidate's costs in the form of a CPV, K of them.
  [[nodiscard]] const double* costs(std::uint32_t candidate, std::uint32_t at_cpv) const {
    return cost.data() + (static_cast<std::size_t>(candidate) * forms + form[at_cpv]) * stages;
  }
  /// How many entries the candidate lists.
  [[nodiscard]] std::uint64_t listed(std::uint32_t candidate) const {
    std::uint64_t entries = 0;
    for (const BlockRun& run : runs_of(candidate)) entries += block_offset[run.end] - block_offset[run.begin];
    return entries;
  }
  /// `entry`: in a block of the candidate.
  [[nodiscard]] double gain(std::uint32_t candidate, std::uint32_t entry, std::uint32_t stage) const {
    return worth[static_cast<std::size_t>(entry) * stages + stage] - costs(candidate, cpv[entry])[stage];
  }
  [[nodiscard]] bool serves(std::uint32_t candidate, std::uint32_t entry) const {
    for (std::uint32_t k = 0; k < stages; ++k)
      if (gain(candidate, entry, k) > 0.0) return true;
    return false;
  }
  /// Calls visit(entry) for every entry of the candidate's blocks, always in the same order.
  template <class Visit>
  void for_each_listed(std::uint32_t candidate, Visit&& visit) const {
    for (const BlockRun& run : runs_of(candidate))
      for (std::uint32_t e = block_offset[run.begin]; e < block_offset[run.end]; ++e) visit(e);
  }
  /// Of these, those where some stage gains: what the candidate serves.
  template <class Visit>
  void for_each_served(std::uint32_t candidate, Visit&& visit) const {
    for_each_listed(candidate, [&](std::uint32_t e) {
      if (serves(candidate, e)) visit(e);
    });
  }
};

/// Why a CPV stayed unsolved.
struct Shortfall {
  std::uint32_t cpv = 0;
  double residual = 0.0;  // what is missing with the best antichain over ALL candidates (math.md 5.4)
};

/// A step that a limit cut short, or kept from beginning.
struct CutShort {
  std::string step;
  double bytes_before = 0.0;
  double bytes_after = 0.0;
};

/// After a step of a selection, also one that a limit cut short. What is chosen then meets all that can be met.
struct SelectionStep {
  std::string name;
  std::uint64_t gains = 0;  // that this selection has looked at so far
  double bytes = 0.0;       // of what is chosen
};

struct SelectionSummary {
  enum class Stop { kAllMet, kSomeUnreachable, kGreedyCutShort } stop = Stop::kAllMet;
  std::string message;
  double bytes_greedy = 0.0;       // after greedy and stall repair
  double bytes = 0.0;              // after reverse-delete and exchange
  double lower_bound_bytes = 0.0;  // lagrangian_bound.h, of the instance without its unreachable CPVs
  std::uint32_t picked_by_greedy = 0;
  std::uint32_t stalled = 0;        // CPVs that the stall repair had to solve
  std::uint64_t evaluations = 0;    // score evaluations
  std::uint64_t gains = 0;          // looked at by all steps: the unit of `most_gains`
  double priced_bound_bytes = 0.0;  // the lower bound behind the prices of the second greedy; 0: no such prices
  bool guided = false;              // the greedy that won went by them
  std::uint64_t trials = 0;         // of ruin and recreate
  std::vector<CutShort> cut_short;
  std::vector<Shortfall> unmet;  // empty iff kAllMet; of a greedy cut short, what is missing with what is chosen
};

struct Selection {
  std::vector<std::uint32_t> chosen;                 // ascending candidate ids
  std::vector<std::vector<std::uint32_t>> assigned;  // per CPV: its antichain, ascending candidate ids
  SelectionSummary summary;
};

struct SelectionConfig {
  bool lazy = true;            // false: plain greedy, the oracle
  int guided_sweeps = 0;       // of the lower bound's search, each time constraints are added, for a second greedy at its prices; 0: none.
                               // Not where `initial` has members
  bool reverse_delete = true;  // false: what the greedy picks is kept
  int exchange_rounds = 0;     // each round tries to add one and delete others
  std::uint64_t recreate_trials = 0;                       // of ruin and recreate. Not where `initial` has members
  int bound_iterations = 100;                              // sweeps and steps, each time constraints are added; 0: no lower bound
  std::uint64_t most_gains = UINT64_MAX;                   // that all steps together may look at: when passed, they end where they are
  std::uint64_t gains_before = 0;                          // that earlier selections under the same limit have looked at
  std::function<bool()> out_of_time = {};                  // a deadline; empty: none. Not deterministic, unless it is
  std::function<void(const SelectionStep&)> on_step = {};  // told after each step; nothing of a greedy cut short
  int threads = 1;                                         // the same result for any number
};

/// `initial`: candidates that are already in S (a repair after baking); greedy goes on from there. Deterministic: ties by score, then lower
/// id.
[[nodiscard]] Selection select_impostors(const SelectionProblem& problem, const SelectionConfig& config,
                                         std::span<const std::uint32_t> initial, const WorkBudget& budget);

/// Lower bound on the bytes of any selection that meets every reachable CPV, from `config.bound_iterations` steps at a time. `known`: a
/// selection; the bound looks at what is tight in it.
[[nodiscard]] double memory_lower_bound(const SelectionProblem& problem, const Selection& known, const SelectionConfig& config,
                                        const WorkBudget& budget);

}  // namespace standin
