// The budget that a fixed subdivision of a scene has so many problem views at: the thesis' Table 5.1 begins with 9,078 at 16 ms, and only
// at as many are its figures comparable with ours (table_5_1.md).
//
//     reference_budget SCENE TARGET.json CPVS [MISSED_SHARE [CONFIG.toml]]
//
// Prints one object of JSON. The configuration (none: the defaults, not refined) must have view_space.refine_levels = 0: halved cells
// change with the budget.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "render/base/error.h"
#include "server/job/surveyed_scene.h"

namespace standin {
namespace {

constexpr double kFirstShare = 0.7;  // of the highest bound: where the search for a threshold low enough begins
constexpr double kNextShare = 0.8;

std::vector<double> bounds_above(const Surveyed& job, double threshold_ms) {
  std::vector<double> predicted;
  for (const Cpv& cpv : problem_views(job, threshold_ms, {}).cpvs) predicted.push_back(cpv.predicted_ms);
  std::ranges::sort(predicted, std::greater());
  return predicted;
}

nlohmann::json reference_budget(const Surveyed& job, std::size_t cpvs) {
  const double worst_ms = problem_views(job, std::numeric_limits<double>::infinity(), {}).worst_predicted_ms;
  std::vector<double> predicted;
  for (double share = kFirstShare; predicted.size() <= cpvs && share > 1e-3; share *= kNextShare)
    predicted = bounds_above(job, share * worst_ms);
  if (predicted.size() <= cpvs) throw Failure(ErrorWord::kBadUsage, "the view space has no more than " + std::to_string(cpvs) + " regions");
  const double budget_ms = job.target.model.bound_ms(0.5 * (predicted[cpvs - 1] + predicted[cpvs]));
  return {{"budget_ms", budget_ms}, {"cpvs", cpvs}, {"worst_bound_ms", job.target.model.bound_ms(worst_ms)}};
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  using namespace standin;
  if (argc < 4) return std::fprintf(stderr, "usage: reference_budget SCENE TARGET CPVS [MISSED_SHARE [CONFIG]]\n"), 2;
  try {
    JobSpec spec;
    spec.lods = "off";  // objects as the scene has them
    spec.refine_levels = 0;
    if (argc > 5) read_config(spec, argv[5]);
    if (argc > 4) spec.visibility_missed_share = std::strtod(argv[4], nullptr);
    if (spec.refine_levels != 0) throw Failure(ErrorWord::kBadUsage, "view_space.refine_levels violates: 0");
    const WorkBudget budget;
    StageClock clock(budget);
    Surveyed job;
    load_job({argv[1], argv[2], {}}, spec, clock, budget, job);
    std::printf("%s\n", reference_budget(job, std::strtoul(argv[3], nullptr, 10)).dump().c_str());
  } catch (const Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 2;
  }
}
