// The order of the stages, and nothing else: the page to read first.
//
//   scene ─▶ view space ─▶ visible sets ─▶ survey ─▶ problem views ─▶ candidates ─▶ selection ⇄ baking ─▶ placement ─▶ verification ─▶
//   files
//
// The command line and the service run these same functions.
#pragma once

#include <nlohmann/json.hpp>

#include "render/base/work.h"
#include "server/job/job_files.h"
#include "server/job/job_spec.h"

namespace standin {

struct JobOutcome {
  nlohmann::json metrics;
  bool aim_met = true;  // false: some CPV has no solution
};

[[nodiscard]] JobOutcome run_survey(const JobFiles& files, const JobSpec& spec, const WorkBudget& budget);
[[nodiscard]] JobOutcome run_place(const JobFiles& files, const JobSpec& spec, const WorkBudget& budget);

}  // namespace standin
