// What an impostor will weigh, from real bakes of this scene's own candidates (thesis 5.8.1).
#pragma once

#include "placement/candidates/size_models.h"
#include "server/job/surveyed_scene.h"

namespace standin {

/// One model per technique that the job offers; the same for every budget.
[[nodiscard]] SizeModels fit_sizes(const Surveyed& job, const JobSpec& spec, const WorkBudget& budget);

}  // namespace standin
