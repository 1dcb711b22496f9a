#include "server/job/survey_metrics.h"

#include <cstdio>
#include <string>

#include "render/visibility/visible_set.h"
#include "server/job/metrics.h"

namespace standin {
namespace {

using nlohmann::json;

// Impostors that lower the highest bound by less than this are no help.
constexpr double kHelpfulShare = 0.98;

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
  const double worst_ms = job.survey.worst_frame_ms;
  if (!reach.known)
    return "without impostors every view can be promised " + without + "; the worst sampled view is estimated at " + milliseconds(worst_ms);
  const std::string promise = "every view can be promised " + milliseconds(reach.all_ms) + ", without them " + without +
                              "; the worst sampled view is estimated at " + milliseconds(worst_ms);
  if (reach.all_ms < worst_ms) return "impostors help: " + promise;
  const std::string blockers = names_of(reach.blockers, job.world.scene);
  const std::string why = blockers.empty() ? "" : "; what is left is near or light geometry, above all " + blockers;
  if (reach.all_ms < kHelpfulShare * reach.worst_bound_ms)
    return "impostors lower what can be promised, yet no promise comes down to the slowest views on this target: " + promise + why;
  return "impostors cannot help the slowest views on this target: " + promise + why;
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

}  // namespace

std::vector<View> slow_views(const Survey& survey) {
  std::vector<View> views;
  for (const SlowView& slow : survey.worst) views.push_back(slow.surveyed.view);
  return views;
}

json common_metrics(const Surveyed& job, const StageClock& clock) {
  const World& world = job.world;
  return {{"scene", {{"name", world.scene.name}, {"objects", world.scene.objects.size()}, {"triangles", world.scene.triangle_count()}}},
          {"view_space", {{"why", world.view_space.why}, {"boxes", world.view_space.boxes.size()}}},
          {"visibility", visibility_json(world, clock)},
          {"lods", lods_json(world.lods)},
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

}  // namespace standin
