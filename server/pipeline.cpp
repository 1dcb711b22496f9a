#include "server/pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

#include "placement/candidates/candidates.h"
#include "placement/view_space/survey.h"
#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "render/image/image_io.h"
#include "render/impostor/atlas.h"
#include "render/impostor/impostor_glb.h"
#include "render/visibility/visible_set.h"
#include "server/files/output_folder.h"
#include "server/files/placement_json.h"
#include "server/job/curves.h"
#include "server/job/gpu_memory.h"
#include "server/job/left_out.h"
#include "server/job/metrics.h"
#include "server/job/reach.h"
#include "server/job/select_and_bake.h"
#include "server/job/target_device.h"
#include "server/job/unsolved.h"
#include "server/job/world.h"
#include "server/report/pictures.h"
#include "server/report/report.h"
#include "server/verify/verify.h"
#include "server/verify/verify_json.h"

namespace standin {
namespace {

using nlohmann::json;

// Impostors that lower the highest bound by less than this are no help.
constexpr double kHelpfulShare = 0.98;
constexpr const char* kNoProblemViews = "no problem views: every region's bound is within the budget";

struct Surveyed {
  World world;
  Target target;
  CandidateOptions candidate_options;
  SizeModels sizes;
  ReachSummary reach;
  Survey survey;
};

CandidateOptions candidate_options_of(const JobSpec& spec, int threads) {
  CandidateOptions options;
  options.apex_deg = spec.apex_deg;
  options.direction_step_deg = spec.direction_step_deg;
  options.shape = spec.cell_shape == "box" ? CellShape::kBox : CellShape::kShaft;
  options.threads = threads;
  options.every_direction = forced(spec, "candidates");
  return options;
}

Subdivision problem_views(const World& world, const TimeModel& model, double predicted_budget_ms, const WorkBudget& budget) {
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = predicted_budget_ms;
  return subdivide(world.scene, world.hierarchy.rank, world.view_space, world.visibility, model, world.camera, world.view_space_options,
                   options, budget);
}

// Meshes are sampled where a layered impostor is a candidate as well, if those are offered: the others are large, slow to bake and hardly
// ever chosen.
void keep_samples(Technique technique, bool beside_layers, std::vector<Candidate>& candidates) {
  std::vector<Candidate> kept;
  const Candidate* layered = nullptr;  // of the cluster and cells at hand: it comes first
  for (const Candidate& candidate : candidates) {
    if (candidate.technique == Technique::kLayered) layered = &candidate;
    const bool has_layered = layered != nullptr && layered->node == candidate.node && layered->cells == candidate.cells;
    if (candidate.technique == technique && (!beside_layers || !is_mesh(technique) || has_layered)) kept.push_back(candidate);
  }
  candidates = std::move(kept);
}

// From real bakes of the technique's own candidates. Of what else is offered, layered impostors alone decide which those are: so the law of
// one technique is the same whatever stands beside it.
SizeModel fit_sizes(const Surveyed& job, const Subdivision& probe, Technique technique, const JobSpec& spec, const WorkBudget& budget) {
  const World& world = job.world;
  SizeModels sizes;
  for (const Technique offered : techniques_of(spec))
    if (offered == technique || offered == Technique::kLayered) sizes.offer(offered, default_size_model(offered));
  CandidateSet set = generate_candidates(world.scene, world.hierarchy, probe, job.target.model, sizes, world.camera, world.quality,
                                         job.candidate_options, budget);
  keep_samples(technique, sizes.offers(Technique::kLayered), set.candidates);
  if (set.candidates.empty()) return default_size_model(technique);
  return fit_size_model(world.scene, set.candidates, world.camera, world.quality, spec.size_bakes, spec.seed, world.threads, budget);
}

// What an impostor will weigh, from real bakes of this scene's own candidates (thesis 5.8.1).
SizeModels fit_sizes(const Surveyed& job, const Subdivision& whole, const JobSpec& spec, const WorkBudget& budget) {
  SizeModels sizes;
  for (const Technique technique : techniques_of(spec)) sizes.offer(technique, default_size_model(technique));
  if (spec.size_bakes == 0) return sizes;
  constexpr double kProbeShare = 0.6;  // enough slow regions for typical candidates
  const Subdivision probe = problem_views(job.world, job.target.model, kProbeShare * whole.worst_predicted_ms, budget);
  for (const Technique technique : techniques_of(spec)) sizes.offer(technique, fit_sizes(job, probe, technique, spec, budget));
  return sizes;
}

json size_models_json(const SizeModels& sizes) {
  json models = json::object();
  for (std::size_t t = 0; t < kTechniqueCount; ++t) {
    const auto technique = static_cast<Technique>(t);
    if (!sizes.offers(technique)) continue;
    const SizeModel& model = sizes.of(technique);
    models[std::string(technique_name(technique))] = {{"bakes", model.bakes}, {"median_error", model.median_error}};
  }
  return models;
}

json impostor_counts(const Placement& placement) {
  json counts = {{"count", placement.impostors.size()}, {"by_technique", json::object()}};
  for (const auto& impostor : placement.impostors) {
    json& count = counts["by_technique"][impostor.technique];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return counts;
}

// What impostors could do for the worst views; where the placement at hand has no problem view, nobody asks.
void add_reach(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  if (problem != nullptr && problem->cpvs.empty() && !forced(spec, "candidates")) {
    clock.skip("size_model", kNoProblemViews);
    clock.leave_out("survey", std::string(kNoProblemViews) + ", so nobody asks how low the budget could go");
    job.reach = without_reach(model, *problem);
    return;
  }
  const Subdivision whole =
      clock.run("survey", [&] { return problem_views(world, model, std::numeric_limits<double>::infinity(), budget); });
  job.sizes = clock.run("size_model", [&] { return fit_sizes(job, whole, spec, budget); });
  job.reach = clock.run("survey", [&] { return summarise_reach(world, model, whole, job.sizes, job.candidate_options, budget); });
}

void load_job(const JobFiles& files, const JobSpec& spec, StageClock& clock, const WorkBudget& budget, Surveyed& job) {
  job.target = read_target(files.target);
  build_world(files.scene, spec, clock, budget, job.world);
  job.candidate_options = candidate_options_of(spec, job.world.threads);
}

// `problem`: the problem views of a placement, if there is one.
void survey_scene(Surveyed& job, const JobSpec& spec, const Subdivision* problem, StageClock& clock, const WorkBudget& budget) {
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

std::string milliseconds(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f ms", value);
  return text;
}

// "tree_6, tree_5, house 3"
std::string names_of(const std::vector<std::uint32_t>& objects, const Scene& scene) {
  std::string names;
  for (const auto object : objects) names += (names.empty() ? "" : ", ") + scene.objects[object].name;
  return names;
}

// How low a budget can be promised, with and without impostors, beside the worst view that was sampled. Promises are bounds, the worst view
// is an estimate: where no promise comes down to it, that is said first.
std::string verdict(const Surveyed& job) {
  const ReachSummary& reach = job.reach;
  const std::string without = milliseconds(reach.worst_bound_ms);
  if (!reach.known) return "no view needs impostors: every bound is within " + without;
  const double worst_ms = job.survey.worst_frame_ms;
  const std::string promise = "every view can be promised " + milliseconds(reach.all_ms) + ", without them " + without +
                              "; the worst sampled view is estimated at " + milliseconds(worst_ms);
  if (reach.all_ms < worst_ms) return "impostors help: " + promise;
  const std::string blockers = names_of(reach.blockers, job.world.scene);
  const std::string why = blockers.empty() ? "" : "; what is left is near or light geometry, above all " + blockers;
  if (reach.all_ms < kHelpfulShare * reach.worst_bound_ms)
    return "impostors lower what can be promised, yet no promise comes down to the slowest views on this target: " + promise + why;
  return "impostors cannot help the slowest views on this target: " + promise + why;
}

std::vector<View> slow_views(const Survey& survey) {
  std::vector<View> views;
  for (const SlowView& slow : survey.worst) views.push_back(slow.surveyed.view);
  return views;
}

json survey_json(const Surveyed& job) {
  const Survey& survey = job.survey;
  const auto if_known = [&](double reachable_ms) { return job.reach.known ? json(reachable_ms) : json(); };
  return {{"worst_frame_ms", survey.worst_frame_ms},
          {"p50_frame_ms", survey.p50_ms},
          {"p90_frame_ms", survey.p90_ms},
          {"p99_frame_ms", survey.p99_ms},
          {"worst_bound_ms", job.reach.worst_bound_ms},
          {"worst_views", slow_views_json(survey.worst)},
          {"bound_over_sampled_p50", survey.looseness_p50},
          {"bound_over_sampled_max", survey.looseness_max},
          {"reachable_all_ms", if_known(job.reach.all_ms)},
          {"reachable_p99_ms", if_known(job.reach.p99_ms)},
          {"reachable_p90_ms", if_known(job.reach.p90_ms)},
          {"verdict", verdict(job)}};
}

json visibility_json(const World& world, const StageClock& clock) {
  const std::size_t cells = world.visibility.cells.size();
  json figures = {{"cells", cells}, {"occlusion", world.occlusion}};
  if (cells == 0) return figures;
  const VisibilityFigures& sets = world.visible_sets;
  figures["missed_share_max"] = sets.highest_missed_share;
  figures["missed_share_mean"] = sets.mean_missed_share;
  figures["confidence"] = kVisibilityConfidence;
  figures["uncertified_cells"] = sets.uncertified_cells;
  figures["worst_view_share"] = sets.worst_view_share;
  figures["views"] = sets.views;
  figures["rays"] = sets.rays;
  figures["seconds_per_cell"] = clock.seconds().value("visibility", 0.0) / static_cast<double>(cells);
  return figures;
}

json common_metrics(const Surveyed& job, const StageClock& clock) {
  const World& world = job.world;
  return {{"scene", {{"name", world.scene.name}, {"objects", world.scene.objects.size()}, {"triangles", world.scene.triangle_count()}}},
          {"view_space", {{"why", world.view_space.why}, {"boxes", world.view_space.boxes.size()}}},
          {"visibility", visibility_json(world, clock)},
          {"target",
           {{"id", job.target.id},
            {"coverage", job.target.model.coverage},
            {"median_error", job.target.median_error},
            {"p90_error", job.target.p90_error}}},
          {"size_model", size_models_json(job.sizes)},
          {"survey", survey_json(job)},
          {"stages_s", clock.seconds()},
          {"left_out", clock.left_out()},
          {"peak_rss_bytes", peak_rss_bytes()}};
}

// Names a job by what goes into it.
std::string fingerprint(const char* kind, const JobFiles& files, const JobSpec& spec) {
  return json({{"kind", kind},
               {"scene", sha256_hex(read_file(files.scene))},
               {"target", sha256_hex(read_file(files.target))},
               {"spec", to_json(spec, true)}})
      .dump();
}

// The selection speaks of the candidates and costs it was given.
std::string select_message(const SelectedImpostors& selected) {
  std::string message = selected.selection.summary.message;
  if (selected.only_baked && !selected.selection.summary.unmet.empty()) message += " that were baked when the rounds ended";
  const std::uint32_t short_cpvs = selected.rounds.empty() ? 0 : selected.rounds.back().short_cpvs;
  if (short_cpvs > 0) message += "; " + std::to_string(short_cpvs) + " more fell short once baked";
  return message;
}

json select_metrics(const SelectedImpostors& selected, const Placement& placement) {
  json rounds = json::array();
  for (const auto& round : selected.rounds)
    rounds.push_back({{"baked", round.baked},
                      {"short_cpvs", round.short_cpvs},
                      {"estimated_bytes", round.estimated_bytes},
                      {"real_bytes", round.real_bytes}});
  const SelectionSummary& summary = selected.selection.summary;
  return {{"message", select_message(selected)}, {"picked_by_greedy", summary.picked_by_greedy}, {"stalled", summary.stalled},
          {"evaluations", summary.evaluations},  {"bytes_greedy", summary.bytes_greedy},         {"impostors", placement.impostors.size()},
          {"rounds", std::move(rounds)}};
}

json memory_json(const Placement& placement, const ImpostorSet& set, json gpu_compression) {
  std::uint64_t texture = 0, geometry = 0;
  for (const auto& impostor : placement.impostors) {
    texture += impostor.texture_bytes;
    geometry += impostor.geometry_bytes;
  }
  return {{"texture_bytes", texture},
          {"geometry_bytes", geometry},
          {"total_bytes", texture + geometry},
          {"atlas_padding_bytes", padding_bytes(set)},
          {"gpu_bytes", gpu_bytes_json(set.pages)},
          {"gpu_compression", std::move(gpu_compression)}};
}

json bound_json(const SelectionSummary& summary) {
  const double gap = summary.bytes > 0.0 ? (summary.bytes - summary.lower_bound_bytes) / summary.bytes : 0.0;
  return {
      {"memory_lower_bound_bytes", summary.lower_bound_bytes},
      {"gap", gap},
      {"holds_for",
       "this candidate set, these CPVs and this time bound; bytes are real where a candidate was baked and a proven lower bound where not, "
       "drawing times of those that were not baked are estimates"}};
}

json cpv_json(const Placement& placement) {
  const auto solved = static_cast<std::uint64_t>(std::ranges::count_if(placement.cpvs, [](const auto& cpv) { return cpv.solved; }));
  return {{"count", placement.cpvs.size()}, {"solved", solved}, {"unsolved", placement.cpvs.size() - solved}};
}

// Error against run time, of every stage that has a dial and was run.
json curves_json(const Surveyed& job, const JobSpec& spec, const Subdivision& subdivision, const SelectedImpostors& selected,
                 std::span<const Impostor> impostors, const StageClock& clock, const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  const std::vector<double> laps = clock.laps("view_space");
  return {{"estimator", estimator_curve(job.target)},
          {"visibility", visibility_curve(world, spec, budget)},
          {"view_space", view_space_curve(world, model, subdivision, laps.back() - laps[laps.size() - 2],
                                          model.predicted_budget_ms(spec.budget_ms), job.survey.worst_frame_ms, budget)},
          {"select", select_curve(selected, clock)},
          {"bake_rounds", bake_rounds_curve(selected, clock)},
          {"bake", bake_curve(world, impostors, budget)}};
}

struct Placed {
  Subdivision subdivision;
  CandidateSet candidates;
  SelectedImpostors selected;
  Placement placement;
  ImpostorSet set;
  std::string glb;
};

void choose_and_bake(const Surveyed& job, const JobSpec& spec, Placed& placed, StageClock& clock, const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  placed.candidates = clock.run("candidates", [&] {
    return generate_candidates(world.scene, world.hierarchy, placed.subdivision, model, job.sizes, world.camera, world.quality,
                               job.candidate_options, budget);
  });
  name_directions_left_out(world, placed.candidates, spec, clock);
  name_texturing_left_out(world.scene, spec, clock);
  placed.selected = select_and_bake(world, placed.subdivision, placed.candidates, job.sizes, model, spec.budget_ms, spec, clock, budget);
  name_culling_left_out(placed.selected.impostors, spec, clock);
}

void place_impostors(const Surveyed& job, const JobSpec& spec, Placed& placed, StageClock& clock, const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  if (placed.subdivision.cpvs.empty() && !forced(spec, "candidates")) {
    for (const char* stage : {"candidates", "select", "bake"}) clock.skip(stage, kNoProblemViews);
    placed.selected.atlas_pages = 1;  // as a selection of nothing has it
  } else {
    choose_and_bake(job, spec, placed, clock, budget);
  }
  clock.run("assemble", [&] {
    std::vector<std::uint32_t> kept;
    placed.placement = assemble_placement(placed.subdivision, world.view_space, placed.selected.baked, placed.selected.assigned, model,
                                          world.camera, spec.budget_ms, placed.selected.page_switch_ms, kept);
    std::vector<Impostor> impostors;
    for (const auto old : kept) impostors.push_back(std::move(placed.selected.impostors[old]));
    placed.set = pack_atlas(std::move(impostors));
    placed.glb = encode_impostor_glb(placed.set);
  });
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

PlacementFile placement_file(const Surveyed& job, const Placed& placed, const JobSpec& spec) {
  return {spec,
          job.world.scene.name,
          job.world.scene.sha256,
          job.target.id,
          job.target.sha256,
          job.target.model.coverage,
          job.world.camera,
          job.world.view_space,
          placed.selected.atlas_pages,
          placed.placement};
}

// Where the inputs lay: outside placement.json, which carries no path.
std::string inputs_json(const JobFiles& files) {
  return json({{"scene", std::filesystem::absolute(files.scene).string()}, {"target", std::filesystem::absolute(files.target).string()}})
      .dump();
}

}  // namespace

JobOutcome run_survey(const JobFiles& files, const JobSpec& spec, const WorkBudget& budget) {
  std::optional<OutputFolder> folder;
  if (!files.folder.empty()) folder.emplace(files.folder, fingerprint("survey", files, spec));
  StageClock clock(budget);
  Surveyed job;
  load_job(files, spec, clock, budget, job);
  survey_scene(job, spec, nullptr, clock, budget);
  JobOutcome outcome;
  outcome.metrics = common_metrics(job, clock);
  outcome.metrics["causes"] = causes_json(job.world, job.reach.subdivision, job.target.model);
  outcome.metrics["heat_map"] = heat_map_json(job.reach.subdivision, nullptr, job.target.model);
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
  placed.subdivision = clock.run("view_space", [&] {
    return problem_views(job.world, job.target.model, job.target.model.predicted_budget_ms(spec.budget_ms), budget);
  });
  survey_scene(job, spec, &placed.subdivision, clock, budget);
  job.reach.subdivision = {};  // as large as the problem views, and only the survey asks for it
  place_impostors(job, spec, placed, clock, budget);
  const json curves =
      clock.run("curves", [&] { return curves_json(job, spec, placed.subdivision, placed.selected, placed.set.impostors, clock, budget); });
  json gpu_compression = clock.run("gpu_compression", [&] { return gpu_compression_json(placed.set.pages, job.world.threads, budget); });
  const VerifyResult verified = clock.run("verify", [&] { return verify(job, placed, spec, budget); });

  const json placement = placement_to_json(placement_file(job, placed, spec), job.world.scene);
  JobOutcome outcome;
  outcome.metrics = common_metrics(job, clock);
  json& metrics = outcome.metrics;
  metrics["budget_ms"] = spec.budget_ms;
  metrics["cpv"] = cpv_json(placed.placement);
  const CandidateSet& candidates = placed.candidates;
  metrics["candidates"] = {{"generated", candidates.generated},
                           {"kept", candidates.candidates.size()},
                           {"pruned", candidates.generated - candidates.candidates.size()},
                           {"duplicates", candidates.duplicates},
                           {"impossible", candidates.impossible},
                           {"hopeless", candidates.hopeless}};
  metrics["impostors"] = impostor_counts(placed.placement);
  metrics["select"] = select_metrics(placed.selected, placed.placement);
  metrics["memory"] = memory_json(placed.placement, placed.set, std::move(gpu_compression));
  metrics["bound"] = bound_json(placed.selected.selection.summary);
  metrics["curves"] = curves;
  metrics["verify"] = verify_json(verified);
  metrics["image"] = image_json(verified);
  metrics["heat_map"] = heat_map_json(placed.subdivision, &placed.placement, job.target.model);
  metrics["causes"] = causes_json(job.world, placed.subdivision, job.target.model);
  metrics.update(
      unsolved_json(job.world, placed.subdivision, placed.placement, placed.selected.selection, job.target.model, spec.budget_ms));
  folder.write(kInputsFile, inputs_json(files));
  folder.write("placement.json", placement.dump());
  folder.write("impostors.glb", placed.glb);
  folder.write("metrics.json", metrics.dump(1));
  folder.write("report.html", make_report(metrics, placement, report_pictures(verified, placed.set)));
  folder.commit();
  outcome.aim_met = metrics["cpv"]["unsolved"] == 0;
  return outcome;
}

}  // namespace standin
