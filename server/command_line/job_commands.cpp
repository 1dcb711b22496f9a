// survey, place and sweep: run the pipeline, say in a few lines what came out.
#include <cstdio>
#include <iostream>
#include <string>

#include "server/command_line/commands.h"
#include "server/job/job_cache.h"
#include "server/pipeline.h"
#include "server/sweep/sweep.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr std::size_t kNamedUnsolved = 10;

JobFiles files_of(const CommandArguments& arguments) {
  return {arguments.scenes.front(), arguments.target, arguments.output};
}

double number(const json& object, const char* section, const char* key) {
  return object.at(section).at(key).get<double>();
}

void print_survey(const json& metrics) {
  std::printf("worst view %.2f ms (p99 %.2f, p50 %.2f); highest bound of a region %.2f ms\n", number(metrics, "survey", "worst_frame_ms"),
              number(metrics, "survey", "p99_frame_ms"), number(metrics, "survey", "p50_frame_ms"),
              number(metrics, "survey", "worst_bound_ms"));
  std::printf("reachable by impostors: %.2f ms for all views, at most %.2f for 99 %%, at most %.2f for 90 %%\n",
              number(metrics, "survey", "reachable_all_ms"), number(metrics, "survey", "reachable_p99_ms"),
              number(metrics, "survey", "reachable_p90_ms"));
  std::printf("%s\n", metrics["survey"]["verdict"].get<std::string>().c_str());
  std::printf("slow regions spend %.0f %% on draws, %.0f %% on triangles, %.0f %% on pixels\n",
              100 * number(metrics, "causes", "draws_share"), 100 * number(metrics, "causes", "triangles_share"),
              100 * number(metrics, "causes", "pixels_share"));
}

void print_left_out(const json& metrics) {
  for (const auto& entry : metrics["left_out"])
    std::printf("left out: %s (%s)\n", entry["stage"].get<std::string>().c_str(), entry["reason"].get<std::string>().c_str());
}

void print_place(const json& metrics) {
  std::printf("%s of %s CPVs solved, %s impostors, %.3f MB of texture (lower bound %.3f MB)\n", metrics["cpv"]["solved"].dump().c_str(),
              metrics["cpv"]["count"].dump().c_str(), metrics["impostors"]["count"].dump().c_str(),
              number(metrics, "memory", "texture_bytes") / 1e6, number(metrics, "bound", "memory_lower_bound_bytes") / 1e6);
  if (metrics["mode"] == "sampled") std::printf("placed for sampled views, not for bounds: nothing is promised of the others\n");
  if (const double lods = number(metrics, "memory", "lods_bytes"); lods > 0.0)
    std::printf("levels of detail of %s objects, %.3f MB, which are no part of the bound\n", metrics["lods"]["objects"].dump().c_str(),
                lods / 1e6);
  std::size_t named = 0;
  for (const auto& entry : metrics["unsolved"]) {
    if (++named > kNamedUnsolved) {
      std::printf("... and %.0f more; metrics.json has the worst, and all by cell and object\n",
                  number(metrics, "cpv", "unsolved") - static_cast<double>(kNamedUnsolved));
      break;
    }
    std::printf("unsolved: cpv %s (%s): %.2f ms, lowest budget %.2f ms, because of", entry["cpv"].dump().c_str(),
                entry["region"].get<std::string>().c_str(), entry["bound_after_ms"].get<double>(), entry["lowest_budget_ms"].get<double>());
    for (const auto& object : entry["blocking"]) std::printf(" %s", object["name"].get<std::string>().c_str());
    std::printf("\n");
  }
  const json& verify = metrics["verify"];
  std::printf("verified %s views: %s over budget (measured), %s (estimated); gap pixels %s, parallax ratio %s\n",
              verify["views"].dump().c_str(), verify["over_budget_measured"].dump().c_str(), verify["over_budget_estimated"].dump().c_str(),
              metrics["image"]["gap_pixels"].dump().c_str(), metrics["image"]["max_parallax_ratio"].dump().c_str());
}

void print_point(const json& point) {
  std::printf("%10.6g ms: %7s CPVs, %s unsolved, %5s impostors, %10.3f kB of texture (lower bound %.3f kB), %.1f s%s\n",
              point["budget_ms"].get<double>(), point["cpv"]["count"].dump().c_str(), point["cpv"]["unsolved"].dump().c_str(),
              point["impostors"].dump().c_str(), point["texture_bytes"].get<double>() / 1e3,
              point["memory_lower_bound_bytes"].get<double>() / 1e3, point["seconds"].get<double>(),
              point["reachable"] == true ? "" : "; below what the survey calls reachable");
}

void print_gates(const json& sweep) {
  for (const auto& budget_ms : sweep["unmet_ms"]) std::printf("not met: %s ms\n", budget_ms.dump().c_str());
  if (sweep.contains("baseline")) {
    const json& baseline = sweep["baseline"];
    for (const auto& one : baseline["regressions"]) std::printf("worse than the baseline %s\n", one["sentence"].get<std::string>().c_str());
    for (const auto& budget_ms : baseline["not_compared_ms"])
      std::printf("not compared: %s ms, not in both curves\n", budget_ms.dump().c_str());
    std::printf("%zu budgets compared with the baseline, %zu worse\n", baseline["compared_ms"].size(), baseline["regressions"].size());
  }
  for (const auto& verdict : sweep.value("acceptance", json::array()))
    std::printf("criterion %s\n", verdict["sentence"].get<std::string>().c_str());
}

void print_sweep(const json& sweep) {
  std::printf("budgets: %s\n", sweep["budgets_from"].get<std::string>().c_str());
  for (const auto& point : sweep["points"]) print_point(point);
  print_gates(sweep);
}

int finish(const JobOutcome& outcome, const CommandContext& context, void (*print)(const json&)) {
  if (context.arguments.json) {
    std::cout << outcome.metrics.dump(2) << "\n";
  } else {
    print(outcome.metrics);
    print_left_out(outcome.metrics);
    if (const std::string sentence = cache_sentence(outcome.metrics); !sentence.empty()) std::printf("%s\n", sentence.c_str());
  }
  return outcome.aim_met ? 0 : 1;
}

}  // namespace

int survey_command(const CommandContext& context) {
  return finish(run_survey(files_of(context.arguments), context.spec, context.budget), context, print_survey);
}

int place_command(const CommandContext& context) {
  return finish(run_place(files_of(context.arguments), context.spec, context.budget), context, print_place);
}

int sweep_command(const CommandContext& context) {
  const SweepGates gates{context.arguments.baseline, context.arguments.acceptance};
  return finish(run_sweep(files_of(context.arguments), gates, context.spec, context.budget), context, print_sweep);
}

}  // namespace standin
