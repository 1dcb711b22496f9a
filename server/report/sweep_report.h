// report.html of a sweep: memory against the budget as one page, the curve first (thesis Table 5.1 as a picture).
//
// It shows what sweep.json holds: points, the lowest reachable budget and the highest bound, the baseline's curve and what got worse since,
// criteria, seconds, what was left out.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace standin {

/// `sweep` is sweep.json. Text from scene files may hold anything.
[[nodiscard]] std::string make_sweep_report(const nlohmann::json& sweep);

}  // namespace standin
