// Selection, baking, and repair with what baking found (architecture.md: bake and repair).
//
// Selection works on estimated bytes and times. What it chose is baked, the real costs go back, once per impostor, and the selection goes
// on from what it holds: CPVs that fell short get further candidates, and impostors that real bytes make redundant go. At most
// `bake_rounds` rounds; if some CPVs are short even then, a last selection among what is baked solves all that it can. The thesis bakes at
// each greedy step (5.7.3) for exact gains: but then bakes cannot run side by side, and most of what the greedy picks along the way is
// deleted again in the end (a third to a half, measured).
#pragma once

#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "placement/candidates/candidates.h"
#include "placement/select/fewest_shown.h"
#include "placement/select/selection_problem.h"
#include "placement/view_space/subdivision.h"
#include "server/job/assemble.h"
#include "server/job/bake_memory.h"
#include "server/job/world.h"

namespace standin {

struct BakeRound {
  std::uint32_t baked = 0;       // in this round
  std::uint32_t short_cpvs = 0;  // that estimates called solved and real costs do not
  double estimated_bytes = 0.0;  // of what was chosen
  double real_bytes = 0.0;
};

struct TimedStep {
  SelectionStep step;
  double seconds = 0.0;  // of wall time, from the selection's beginning
};

/// The bound at the sizes and costs that the last selection was made with: real for what was baked, estimated for the rest.
struct BoundAsSelected {
  double bytes = 0.0;  // of the selection, at these sizes
  double lower_bound_bytes = 0.0;
};

struct SelectedImpostors {
  Selection selection;                               // of the last round
  std::vector<Impostor> impostors;                   // in the order of selection.chosen
  std::vector<BakedCandidate> baked;                 // the same order
  std::vector<std::vector<std::uint32_t>> assigned;  // per CPV: indices into `impostors`, ascending
  std::vector<TimedStep> first_steps;                // of the first selection
  double first_bound_bytes = 0.0;  // on the bytes of any choice, at the sizes that the first selection knew; 0: none is known
  std::vector<BakeRound> rounds;
  bool only_baked = false;  // the last selection was among what is baked
  BoundAsSelected as_selected;
  ShownImpostors shown;     // impostors shown, summed over the regions
  std::uint64_t gains = 0;  // looked at by all selections, as are the evaluations
  std::uint64_t evaluations = 0;
  std::uint64_t picked_by_greedy = 0;  // in all rounds, as those stalled
  std::uint64_t stalled = 0;
  std::vector<std::string> limits;  // messages of selections that a limit cut short
  std::uint32_t atlas_pages = 0;
  double page_switch_ms = 0.0;  // all pages, as every region that draws an impostor is charged
};

/// `bakes`: shared with jobs at other budgets, or none; the result is the same.
[[nodiscard]] SelectedImpostors select_and_bake(const World& world, const Subdivision& subdivision, const CandidateSet& candidates,
                                                const SizeModels& sizes, const TimeModel& model, double budget_ms, const JobSpec& spec,
                                                BakeMemory* bakes, StageClock& clock, const WorkBudget& budget);

}  // namespace standin
