// Error against run time, stage by stage: what more time would buy (architecture.md, error against run time).
//
// Selection and baking report what happened on the way. Visibility, subdivision and baking are run once more on less (larger missed shares,
// fewer halvings, coarser texels), the first and the last on a few regions and impostors only, their seconds scaled up to all: together
// some tens of percent of these stages' time.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "estimation/time_model.h"
#include "server/job/select_and_bake.h"
#include "server/job/world.h"

namespace standin {

/// All curves are lists of {seconds, work, error, unit}, in the order of `seconds`; empty where there is nothing to measure.

/// Held-out median error of the target's time model, as its calibration learned. Work: timed frames.
[[nodiscard]] nlohmann::json estimator_curve(const Target& target);
/// Certified missed share of rays, by the share asked for, mean over at most 8 regions. Work: rays per region.
[[nodiscard]] nlohmann::json visibility_curve(const World& world, const JobSpec& spec, const WorkBudget& budget);
/// Highest bound of a region over the worst sampled view, by halvings in position, of the 4 slowest leaf cubes of `subdivision`. Work:
/// cells.
[[nodiscard]] nlohmann::json view_space_curve(const World& world, const TimeModel& model, const Subdivision& subdivision,
                                              double predicted_budget_ms, double worst_sampled_ms, const WorkBudget& budget);
/// Gap to the lower bound after each step of the first selection, at the sizes that it knew; empty without a second greedy, whose prices
/// are that bound's. Work: gains looked at. Each has the `step`'s name, too.
[[nodiscard]] nlohmann::json select_curve(const SelectedImpostors& selected);
/// Bytes of what is chosen after each round. Work: impostors baked so far.
[[nodiscard]] nlohmann::json bake_rounds_curve(const SelectedImpostors& selected, const StageClock& clock);
/// Side of a texel in centre pixels: 4, 2 and 1 times the job's, over at most 8 of the impostors, scaled up by
/// their bytes. Work: texture bytes of all.
[[nodiscard]] nlohmann::json bake_curve(const World& world, std::span<const Impostor> impostors, const WorkBudget& budget);

}  // namespace standin
