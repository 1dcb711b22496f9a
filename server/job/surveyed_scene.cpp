#include "server/job/surveyed_scene.h"

#include <limits>
#include <utility>

#include "server/cache/search_cache.h"
#include "server/job/fit_sizes.h"
#include "server/job/job_cache.h"

namespace standin {
namespace {

CellShape cell_shape_of(const JobSpec& spec) {
  if (spec.cell_shape == "pyramid") return CellShape::kPyramid;
  if (spec.cell_shape == "box") return CellShape::kBox;
  return spec.cell_shape == "cell" ? CellShape::kCell : CellShape::kShaft;
}

CandidateOptions candidate_options_of(const JobSpec& spec, int threads) {
  CandidateOptions options;
  options.apex_deg = spec.apex_deg;
  options.direction_step_deg = spec.direction_step_deg;
  options.shape = cell_shape_of(spec);
  options.threads = threads;
  options.every_direction = forced(spec, "candidates");
  return options;
}

void add_sizes(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget) {
  if (problem != nullptr && problem->cpvs.empty() && !forced(spec, "candidates"))
    clock.skip("size_model", kNoProblemViews);
  else
    job.sizes = clock.run("size_model", [&] { return fit_sizes(job, spec, budget); });
}

// What impostors could do for the worst views.
void add_reach(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget) {
  const TimeModel& model = job.target.model;
  if (problem != nullptr && !forced(spec, "candidates")) {
    clock.leave_out("survey", problem->cpvs.empty()
                                  ? std::string(kNoProblemViews) + ", so nobody asks how low the budget could go"
                                  : "how low another budget might go: the selection says it of each region it cannot solve");
    job.reach = without_reach(model, *problem);
    return;
  }
  job.reach = clock.run("survey", [&] {
    const Subdivision whole = problem_views(job, std::numeric_limits<double>::infinity(), budget);
    budget.found({{"worst_bound_ms", model.bound_ms(whole.worst_predicted_ms)}});
    return summarise_reach(job.world, model, whole, job.sizes, job.candidate_options, budget, job.searches.get());
  });
}

}  // namespace

void load_job(const JobFiles& files, const JobSpec& spec, StageClock& clock, const WorkBudget& budget, Surveyed& job) {
  job.cache = open_cache(spec, files.folder);
  job.target = read_target(files.target);
  build_world(files.scene, spec, clock, budget, job.world, job.cache.get());
  job.searches = fresh_searches(job, spec);
  job.candidate_options = candidate_options_of(spec, job.world.threads);
}

// Sampled views depend on the cells' parts, and what is known beside them on the budget: neither is in a search's name.
std::unique_ptr<SearchMemory> fresh_searches(const Surveyed& job, const JobSpec& spec) {
  if (job.cache == nullptr || region_bounds(spec) == RegionBounds::kByView) return std::make_unique<SearchMemory>();
  const World& world = job.world;
  const SearchScene scene{world.scene, world.hierarchy.rank, world.visibility, job.target.model, world.camera, world.view_space_options};
  return std::make_unique<SearchCache>(*job.cache, scene);
}

Subdivision problem_views(const Surveyed& job, double predicted_budget_ms, const WorkBudget& budget, std::vector<CellKey> leaves) {
  const World& world = job.world;
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = predicted_budget_ms;
  options.leaves = std::move(leaves);
  return subdivide(world.scene, world.hierarchy.rank, world.view_space, world.visibility, job.target.model, world.camera,
                   world.view_space_options, options, budget, job.searches.get());
}

std::optional<Subdivision> levels_in_vain(Surveyed& job, const JobSpec& spec, const Subdivision& problem, const WorkBudget& budget) {
  if (!job.world.lods.used || spec.lods == "on" || !problem.cpvs.empty()) return std::nullopt;
  std::vector<std::vector<ObjectLevel>> levels;
  for (Object& object : job.world.scene.objects) levels.push_back(std::exchange(object.levels, {}));
  auto searches = std::exchange(job.searches, fresh_searches(job, spec));  // those of the scene with its levels
  Subdivision without = problem_views(job, job.target.model.predicted_budget_ms(spec.budget_ms), budget);
  job.searches = std::move(searches);
  for (std::size_t id = 0; id < levels.size(); ++id) job.world.scene.objects[id].levels = std::move(levels[id]);
  return without.cpvs.empty() ? std::optional(std::move(without)) : std::nullopt;
}

void survey_scene(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget) {
  add_sizes(job, spec, problem, clock, budget);
  add_reach(job, spec, problem, clock, budget);
  clock.run("survey", [&] {
    SurveyOptions options;
    options.views = static_cast<std::uint32_t>(spec.survey_views);
    options.seed = spec.seed;
    options.threads = job.world.threads;
    job.survey =
        survey_views(job.world.scene, job.world.view_space, job.reach.subdivision, job.target.model, job.world.camera, options, budget);
  });
}

}  // namespace standin
