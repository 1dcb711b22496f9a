#include "server/pipeline.h"

#include <optional>
#include <span>
#include <string>

#include "render/base/error.h"
#include "render/image/image_io.h"
#include "server/files/output_folder.h"
#include "server/files/placement_json.h"
#include "server/job/curves.h"
#include "server/job/gpu_memory.h"
#include "server/job/job_cache.h"
#include "server/job/metrics.h"
#include "server/job/place_at_budget.h"
#include "server/job/placement_metrics.h"
#include "server/job/survey_metrics.h"
#include "server/job/surveyed_scene.h"
#include "server/job/target_device.h"
#include "server/job/unsolved.h"
#include "server/report/pictures.h"
#include "server/report/report.h"
#include "server/verify/verify.h"
#include "server/verify/verify_json.h"

namespace standin {
namespace {

using nlohmann::json;

// Error against run time, of every stage that has a dial and was run.
json curves_json(const Surveyed& job, const JobSpec& spec, const Subdivision& subdivision, const SelectedImpostors& selected,
                 std::span<const Impostor> impostors, const StageClock& clock, const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  return {{"estimator", estimator_curve(job.target)},
          {"visibility", visibility_curve(world, spec, budget)},
          {"view_space",
           view_space_curve(world, model, subdivision, model.predicted_budget_ms(spec.budget_ms), job.survey.worst_frame_ms, budget)},
          {"select", select_curve(selected)},
          {"bake_rounds", bake_rounds_curve(selected, clock)},
          {"bake", bake_curve(world, impostors, budget)}};
}

// Levels of detail that nobody needs at this budget go before anything else is done.
void find_problem_views(Surveyed& job, const JobSpec& spec, Placed& placed, StageClock& clock, const WorkBudget& budget) {
  clock.run("view_space", [&] {
    placed.subdivision = problem_views(job, job.target.model.predicted_budget_ms(spec.budget_ms), budget);
    if (auto without = levels_in_vain(job, spec, placed.subdivision, budget)) {
      placed.subdivision = *std::move(without);
      leave_lods_out(kLevelsInVain, spec, job.world, clock);
      job.searches = fresh_searches(job, spec);  // what was searched had levels
    }
  });
  placed.shows_levels = job.world.lods.used;
}

VerifyResult verify(const Surveyed& job, const Placed& placed, const JobSpec& spec, const WorkBudget& budget) {
  const World& world = job.world;
  const double alpha_rad = world.quality.alpha_scale * world.camera.pixel_angle_rad();
  const VerifyInput input{world.scene, job.target,     placed.placement, world.view_space,          world.camera,
                          placed.glb,  spec.budget_ms, alpha_rad,        job.survey.worst_frame_ms, slow_views(job.survey)};
  VerifyOptions options;
  options.views = spec.verify_views;
  options.seed = spec.seed + 1;  // not the views the survey saw
  options.threads = world.threads;
  return verify_placement(input, device_kind(job.target), device_matches(job.target), options, budget);
}

}  // namespace

JobOutcome run_survey(const JobFiles& files, const JobSpec& spec, const WorkBudget& budget) {
  require_bounds("survey", spec);
  std::optional<OutputFolder> folder;
  if (!files.folder.empty()) folder.emplace(files.folder, fingerprint("survey", files, spec));
  StageClock clock(budget);
  Surveyed job;
  load_job(files, spec, clock, budget, job);
  survey_scene(job, spec, nullptr, clock, budget);
  const auto causes = clock.run("causes", [&] { return causes_per_cell(job.world, job.reach.subdivision, job.target.model, budget); });
  JobOutcome outcome;
  outcome.metrics = common_metrics(job, clock);
  close_cache(job.cache.get(), spec, outcome.metrics);
  outcome.metrics["causes"] = causes_json(job.world, causes);
  outcome.metrics["heat_map"] = heat_map_json(job.world, job.reach.subdivision, causes, nullptr, job.target.model);
  outcome.metrics["curves"] = {{"estimator", estimator_curve(job.target)}};
  if (spec.budget_ms > 0.0) outcome.metrics["budget_ms"] = spec.budget_ms;
  if (!folder) return outcome;
  folder->write("metrics.json", outcome.metrics.dump(1));
  folder->write("report.html", make_report(outcome.metrics, nullptr, {}));
  folder->commit();
  return outcome;
}

JobOutcome run_place(const JobFiles& files, const JobSpec& spec, const WorkBudget& budget) {
  if (!(spec.budget_ms > 0.0)) throw Failure(ErrorWord::kBadUsage, "--budget-ms " + std::to_string(spec.budget_ms) + " violates: > 0");
  OutputFolder folder(files.folder, fingerprint("place", files, spec));
  StageClock clock(budget);
  Surveyed job;
  Placed placed;
  load_job(files, spec, clock, budget, job);
  find_problem_views(job, spec, placed, clock, budget);
  survey_scene(job, spec, &placed.subdivision, clock, budget);
  job.reach.subdivision = {};  // as large as the problem views, and only the survey asks for it
  job.searches.reset();
  place_at_budget(job, spec, placed, nullptr, clock, budget);
  const json curves =
      clock.run("curves", [&] { return curves_json(job, spec, placed.subdivision, placed.selected, placed.set.impostors, clock, budget); });
  const auto causes = clock.run("causes", [&] { return causes_per_cell(job.world, placed.subdivision, job.target.model, budget); });
  json gpu_compression = clock.run("gpu_compression", [&] { return gpu_compression_json(placed.set.pages, job.world.threads, budget); });
  const VerifyResult verified = clock.run("verify", [&] { return verify(job, placed, spec, budget); });

  const json placement = placement_to_json(placement_file(job, placed, spec), job.world.scene);
  JobOutcome outcome;
  outcome.metrics = common_metrics(job, clock);
  json& metrics = outcome.metrics;
  close_cache(job.cache.get(), spec, metrics);
  metrics["budget_ms"] = spec.budget_ms;
  metrics["mode"] = region_bounds(spec) == RegionBounds::kByView ? "sampled" : "certified";
  metrics["cpv"] = cpv_json(placed.placement);
  metrics["candidates"] = candidates_json(placed.candidates);
  metrics["impostors"] = impostor_counts(placed.placement);
  metrics["select"] = select_metrics(placed.selected, placed.placement);
  metrics["memory"] = memory_json(placed, job.world.lods);
  metrics["memory"]["gpu_bytes"] = gpu_bytes_json(placed.set.pages);
  metrics["memory"]["gpu_compression"] = std::move(gpu_compression);
  metrics["bound"] = bound_json(placed.selected);
  metrics["curves"] = curves;
  metrics["verify"] = verify_json(verified);
  metrics["image"] = image_json(verified);
  metrics["heat_map"] = heat_map_json(job.world, placed.subdivision, causes, &placed.placement, job.target.model);
  metrics["causes"] = causes_json(job.world, causes);
  metrics.update(
      unsolved_json(job.world, placed.subdivision, placed.placement, placed.selected.selection, job.target.model, spec.budget_ms));
  folder.write(kInputsFile, inputs_json(files));
  folder.write("placement.json", placement.dump());
  folder.write("impostors.glb", placed.glb);
  if (placed.shows_levels) folder.write("lods.glb", job.world.lods.file.glb);
  folder.write("metrics.json", metrics.dump(1));
  for (std::size_t k = 0; k < verified.pictures.size(); ++k) folder.write(picture_file(k), encode_png(verified.pictures[k].side_by_side()));
  folder.write("report.html", make_report(metrics, placement, report_pictures(verified, placed.set)));
  folder.commit();
  outcome.aim_met = metrics["cpv"]["unsolved"] == 0;
  return outcome;
}

}  // namespace standin
