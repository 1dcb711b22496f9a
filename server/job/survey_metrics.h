// The part of metrics.json that every job on a surveyed scene has: the scene, the target, what is slow and how low a budget may go, in
// numbers and in a sentence.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "server/job/surveyed_scene.h"

namespace standin {

[[nodiscard]] nlohmann::json common_metrics(const Surveyed& job, const StageClock& clock);
/// The views of the slowest frames that the survey found.
[[nodiscard]] std::vector<View> slow_views(const Survey& survey);

}  // namespace standin
