// A scene with its target, surveyed: what every budget of one job shares (thesis 5.5, and 5.8.1 for the size models).
//
// Loading, visible sets, size models, what is reachable and which views are slow do not depend on the budget, and take most of the seconds:
// `survey` reports them, `place` goes on from them once, `sweep` once for each budget.
#pragma once

#include <memory>
#include <optional>

#include "estimation/time_model.h"
#include "placement/candidates/candidates.h"
#include "placement/view_space/survey.h"
#include "server/cache/stage_cache.h"
#include "server/job/job_files.h"
#include "server/job/reach.h"
#include "server/job/world.h"

namespace standin {

/// Why stages are left out where there is nothing to place.
inline constexpr const char* kNoProblemViews = "no problem views: every region's bound is within the budget";
inline constexpr const char* kLevelsInVain = "no problem views without them: every region's bound is within the budget";

struct Surveyed {
  std::unique_ptr<StageCache> cache;  // of results that outlive the job; none: none do
  World world;
  Target target;
  CandidateOptions candidate_options;
  SizeModels sizes;
  ReachSummary reach;
  Survey survey;
  std::unique_ptr<SearchMemory> searches = std::make_unique<SearchMemory>();  // of all subdivisions so far; reset to free it
};

/// Stages load, view_space, visibility and lods. Opens the cache that `spec` names, if it does, before any work is done.
void load_job(const JobFiles& files, const JobSpec& spec, StageClock& clock, const WorkBudget& budget, Surveyed& job);

/// What is known of searches of the scene as it is now: nothing yet, or what the job's cache holds.
[[nodiscard]] std::unique_ptr<SearchMemory> fresh_searches(const Surveyed& job, const JobSpec& spec);

/// The regions whose predicted bound exceeds the budget. `leaves`: of these leaf cubes, sorted; empty: of all.
[[nodiscard]] Subdivision problem_views(const Surveyed& job, double predicted_budget_ms, const WorkBudget& budget,
                                        std::vector<CellKey> leaves = {});

/// The same regions with every object drawn as it is in the file, where levels of detail are used, not asked for by name, and leave no
/// region over the budget; nothing where that is not so or some region is over budget without them: levels are of use.
[[nodiscard]] std::optional<Subdivision> levels_in_vain(Surveyed& job, const JobSpec& spec, const Subdivision& problem,
                                                        const WorkBudget& budget);

/// Stages size_model and survey. `problem`: the problem views of a placement, if there is one: how low another budget might go is then left
/// out, since the selection says of each region that it cannot solve what it could be brought to.
void survey_scene(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget);

}  // namespace standin
