#include "server/sweep/sweep.h"

#include <algorithm>
#include <optional>

#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "server/files/output_folder.h"
#include "server/job/job_cache.h"
#include "server/job/metrics.h"
#include "server/job/place_at_budget.h"
#include "server/job/placement_metrics.h"
#include "server/job/survey_metrics.h"
#include "server/job/unsolved.h"
#include "server/report/sweep_report.h"
#include "server/sweep/acceptance.h"
#include "server/sweep/baseline.h"
#include "server/sweep/budgets.h"

namespace standin {
namespace {

using nlohmann::json;

/// What the curve is held against, read and found to belong to this sweep before any work is done.
struct Gates {
  std::optional<Curve> baseline;
  std::vector<Criterion> criteria;  // of this target
};

CurveSubject subject_of(const JobFiles& files, const JobSpec& spec) {
  return {files.scene.filename().string(), read_target(files.target).id, spec.fov_y_deg, spec.width, spec.height};
}

Gates read_gates(const SweepGates& files, const CurveSubject& subject) {
  Gates gates;
  if (!files.baseline.empty()) {
    gates.baseline = read_baseline(files.baseline);
    require_same_subject(gates.baseline->subject, subject, files.baseline.string());
  }
  if (!files.acceptance.empty())
    gates.criteria = criteria_for(read_acceptance(files.acceptance), subject.target, files.acceptance.string());
  return gates;
}

/// Nothing where they are to be chosen once the scene was surveyed.
std::optional<SweepBudgets> named_budgets(const JobSpec& spec, const Gates& gates) {
  std::vector<double> budgets = spec.sweep_budgets_ms;
  std::string from = budgets.empty() ? "" : "named";
  if (budgets.empty() && gates.baseline) {
    for (const CurvePoint& point : gates.baseline->points) budgets.push_back(point.budget_ms);
    from = "those of the baseline";
  }
  for (const Criterion& criterion : gates.criteria) budgets.push_back(criterion.budget_ms);
  if (budgets.empty()) return std::nullopt;
  if (!gates.criteria.empty()) from += from.empty() ? "those of the criteria" : ", and those of the criteria";
  return SweepBudgets{ascending(std::move(budgets)), from};
}

json gate_fingerprint(const SweepGates& files, const JobSpec& spec) {
  const auto content = [](const std::filesystem::path& file) { return file.empty() ? json() : json(sha256_hex(read_file(file))); };
  return {{"budgets_ms", spec.sweep_budgets_ms},
          {"tolerance", spec.sweep_tolerance},
          {"baseline", content(files.baseline)},
          {"acceptance", content(files.acceptance)}};
}

CurvePoint point_of(const Surveyed& job, const Placed& placed, double budget_ms, const json& stages_s) {
  const Placement& placement = placed.placement;
  CurvePoint point;
  point.budget_ms = budget_ms;
  point.reachable = !job.reach.known || budget_ms >= job.reach.all_ms;
  point.cpvs = placement.cpvs.size();
  point.unsolved = static_cast<std::uint64_t>(std::ranges::count_if(placement.cpvs, [](const auto& cpv) { return !cpv.solved; }));
  point.impostors = placement.impostors.size();
  for (const auto& impostor : placement.impostors) {
    point.texture_bytes += impostor.texture_bytes;
    point.geometry_bytes += impostor.geometry_bytes;
  }
  point.lods_bytes = placed.shows_levels ? job.world.lods.file.buffer_bytes : 0;
  const json bound = bound_json(placed.selected);
  point.lower_bound_bytes = bound["memory_lower_bound_bytes"];
  point.gap = bound["gap"];
  for (const auto& stage : stages_s) point.seconds += stage.get<double>();
  return point;
}

struct SweptPoint {
  CurvePoint point;
  json numbers;  // its entry of sweep.json
};

SweptPoint sweep_budget(Surveyed& job, JobSpec spec, double budget_ms, BakeMemory& bakes, const WorkBudget& budget) {
  spec.budget_ms = budget_ms;
  budget.report(milliseconds_text(budget_ms), 0.0);
  bakes.begin_job();
  const std::uint64_t baked_before = bakes.kept(), recalled_before = bakes.recalled();
  StageClock clock(budget);
  Placed placed;
  clock.run("view_space", [&] {
    placed.subdivision = problem_views(job, job.target.model.predicted_budget_ms(budget_ms), budget);
    auto without = levels_in_vain(job, spec, placed.subdivision, budget);
    placed.shows_levels = job.world.lods.used && !without;
    if (without) placed.subdivision = *std::move(without);
  });
  if (job.world.lods.used && !placed.shows_levels && !forced(spec, "lods")) clock.leave_out("lods", kLevelsInVain);
  place_at_budget(job, spec, placed, &bakes, clock, budget);
  SweptPoint swept{point_of(job, placed, budget_ms, clock.seconds()), {}};
  swept.numbers = to_json(swept.point);
  swept.numbers.update({{"candidates", candidates_json(placed.candidates)},
                        {"bakes", {{"baked", bakes.kept() - baked_before}, {"recalled", bakes.recalled() - recalled_before}}},
                        {"placement_sha256", sha256_hex(placement_to_json(placement_file(job, placed, spec), job.world.scene).dump())},
                        {"impostors_sha256", sha256_hex(placed.glb)},
                        {"stages_s", clock.seconds()},
                        {"left_out", clock.left_out()}});
  if (!swept.point.met())
    swept.numbers["unsolved_by_object"] = unsolved_json(job.world, placed.subdivision, placed.placement, placed.selected.selection,
                                                        job.target.model, budget_ms)["unsolved_by_object"];
  return swept;
}

/// From loose to tight: the bakes of one budget serve the next.
std::vector<SweptPoint> sweep_budgets(Surveyed& job, const JobSpec& spec, const std::vector<double>& budgets_ms, const WorkBudget& budget) {
  BakeMemory bakes;
  const WorkBudget of_a_point = budget.without_findings();
  std::vector<SweptPoint> swept;
  for (auto budget_ms = budgets_ms.rbegin(); budget_ms != budgets_ms.rend(); ++budget_ms) {
    swept.push_back(sweep_budget(job, spec, *budget_ms, bakes, of_a_point));
    const auto met = std::ranges::count_if(swept, [](const SweptPoint& one) { return one.point.met(); });
    budget.found({{"points", static_cast<double>(swept.size())}, {"unsolved_points", static_cast<double>(std::ssize(swept) - met)}});
  }
  std::ranges::reverse(swept);
  return swept;
}

/// Unsolved CPVs are a failure unless the baseline has as many at that budget, or a criterion accepts them.
bool excused(const CurvePoint& point, const Gates& gates) {
  if (point.met()) return true;
  const CurvePoint* const before = gates.baseline ? point_at(gates.baseline->points, point.budget_ms) : nullptr;
  if (before != nullptr && point.unsolved <= before->unsolved) return true;
  return std::ranges::any_of(gates.criteria, [&](const Criterion& criterion) {
    return criterion.budget_ms == point.budget_ms && point.unsolved <= criterion.max_unsolved;
  });
}

json baseline_points(const std::vector<CurvePoint>& points) {
  json list = json::array();
  for (const CurvePoint& point : points)
    list.push_back({{"budget_ms", point.budget_ms}, {"met", point.met()}, {"texture_bytes", point.texture_bytes}});
  return list;
}

/// Adds what the gates say to sweep.json; whether all pass.
bool pass_gates(const Gates& gates, const std::vector<CurvePoint>& points, double tolerance, json& sweep) {
  json unmet = json::array();
  for (const CurvePoint& point : points)
    if (!excused(point, gates)) unmet.push_back(point.budget_ms);
  bool passed = unmet.empty();
  sweep["unmet_ms"] = std::move(unmet);
  if (gates.baseline) {
    const CurveComparison comparison = compare_curves(gates.baseline->points, points, tolerance);
    sweep["baseline"] = to_json(comparison, tolerance);
    sweep["baseline"]["points"] = baseline_points(gates.baseline->points);
    passed = passed && comparison.regressions.empty();
  }
  if (!gates.criteria.empty()) {
    const std::vector<Verdict> verdicts = judge(gates.criteria, points);
    sweep["acceptance"] = to_json(verdicts);
    passed = passed && std::ranges::all_of(verdicts, [](const Verdict& verdict) { return verdict.failures.empty(); });
  }
  sweep["passed"] = passed;
  return passed;
}

/// All seconds by stage: what the budgets share, and what each took.
json all_stages(const json& shared, const std::vector<SweptPoint>& swept) {
  json stages = shared;
  for (const SweptPoint& one : swept)
    for (const auto& [stage, seconds] : one.numbers["stages_s"].items()) stages[stage] = stages.value(stage, 0.0) + seconds.get<double>();
  return stages;
}

/// Budgets without a common one would be noticed only after the work.
void require_common_budget(const Gates& gates, const std::vector<double>& budgets_ms) {
  if (!gates.baseline) return;
  std::vector<CurvePoint> planned(budgets_ms.size());
  for (std::size_t i = 0; i < planned.size(); ++i) planned[i].budget_ms = budgets_ms[i];
  static_cast<void>(compare_curves(gates.baseline->points, planned, 0.0));
}

}  // namespace

JobOutcome run_sweep(const JobFiles& files, const SweepGates& gate_files, const JobSpec& spec, const WorkBudget& budget) {
  require_bounds("sweep", spec);
  const CurveSubject subject = subject_of(files, spec);
  const Gates gates = read_gates(gate_files, subject);
  std::optional<SweepBudgets> budgets = named_budgets(spec, gates);
  if (budgets) require_common_budget(gates, budgets->budgets_ms);
  OutputFolder folder(files.folder, fingerprint("sweep", files, spec, gate_fingerprint(gate_files, spec)));
  StageClock clock(budget);
  Surveyed job;
  load_job(files, spec, clock, budget, job);
  survey_scene(job, spec, nullptr, clock, budget);
  job.reach.subdivision = {};  // as large as the problem views, and only the survey asks for it
  if (!budgets) budgets = choose_budgets(job.reach.all_ms, job.reach.worst_bound_ms);
  const std::vector<SweptPoint> swept = sweep_budgets(job, spec, budgets->budgets_ms, budget);

  JobOutcome outcome;
  json& sweep = outcome.metrics;
  sweep = common_metrics(job, clock);
  close_cache(job.cache.get(), spec, sweep);
  sweep.merge_patch(to_json(subject));
  sweep["scene"]["sha256"] = job.world.scene.sha256;
  sweep["spec"] = to_json(spec, true);
  sweep["budgets_from"] = budgets->chosen;
  sweep["shared_stages_s"] = clock.seconds();
  sweep["stages_s"] = all_stages(clock.seconds(), swept);
  std::vector<CurvePoint> points;
  for (const SweptPoint& one : swept) {
    points.push_back(one.point);
    sweep["points"].push_back(one.numbers);
  }
  outcome.aim_met = pass_gates(gates, points, spec.sweep_tolerance, sweep);
  folder.write("sweep.json", sweep.dump(1));
  folder.write("report.html", make_sweep_report(sweep));
  folder.commit();
  return outcome;
}

}  // namespace standin
