// The covering problem of a scene, into a file: for selection.cpp.
//
//     selection_dump SCENE TARGET BUDGET_MS FILE
//
// What `place` does up to its first selection, without the survey's views: sizes are those of the fitted size models.
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "placement/candidates/selection_input.h"
#include "server/job/surveyed_scene.h"
#include "tests/bench/selection_file.h"

namespace standin {
namespace {

void dump(const JobFiles& files, double budget_ms, const std::string& out) {
  const WorkBudget budget;
  JobSpec spec;
  spec.lods = "off";  // objects as the scene has them
  spec.budget_ms = budget_ms;
  spec.survey_views = 1;
  StageClock clock(budget);
  Surveyed job;
  load_job(files, spec, clock, budget, job);
  const Subdivision subdivision = problem_views(job, job.target.model.predicted_budget_ms(budget_ms), budget);
  survey_scene(job, spec, &subdivision, clock, budget);
  const World& world = job.world;
  const CandidateSet candidates = generate_candidates(world.scene, world.hierarchy, subdivision, job.target.model, job.sizes, world.camera,
                                                      world.quality, job.candidate_options, budget);
  const SelectionBudget limits{job.target.model.predicted_budget_ms(budget_ms), 0.0};
  const SelectionProblem problem =
      make_selection_problem(world.hierarchy, subdivision, candidates, job.target.model, world.camera, limits, world.threads, budget);
  write_selection_problem(problem, out);
  std::printf("%u CPVs, %u candidates\n", problem.cpv_count(), problem.candidate_count());
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    if (argc != 5) throw standin::Failure(standin::ErrorWord::kBadUsage, "selection_dump SCENE TARGET BUDGET_MS FILE");
    standin::dump({argv[1], argv[2], {}}, std::strtod(argv[3], nullptr), argv[4]);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
