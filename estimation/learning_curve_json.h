// A learning curve as target files and `calibrate --json` write it.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "estimation/time_model.h"

namespace standin {

[[nodiscard]] inline nlohmann::json learning_curve_json(const std::vector<LearningPoint>& curve) {
  nlohmann::json list = nlohmann::json::array();
  for (const LearningPoint& point : curve)
    list.push_back({{"seconds", point.seconds},
                    {"frames", point.frames},
                    {"median_error", point.median_error},
                    {"p90_error", point.p90_error},
                    {"coverage", point.coverage},
                    {"bound_over_measured_median", point.bound_over_measured_median}});
  return list;
}

}  // namespace standin
