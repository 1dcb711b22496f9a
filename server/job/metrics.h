// Parts of metrics.json that need more than a copy: the heat map, slow views. Units in the key names, as everywhere in that file.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/subdivision.h"
#include "placement/view_space/survey.h"
#include "server/job/causes.h"
#include "server/job/world.h"

namespace standin {

/// The slowest views that a survey found, one a cell, slowest first; frame_ms is estimated.
[[nodiscard]] nlohmann::json slow_views_json(const std::vector<SlowView>& slow);
/// Their views, from metrics.json's survey.worst_views.
[[nodiscard]] std::vector<View> slow_views_from_json(const nlohmann::json& worst_views);

/// Per cell in plan view: the highest bound of any direction, before and (where there is a placement) after; and the
/// cause, of cells that have one.
[[nodiscard]] nlohmann::json heat_map_json(const World& world, const Subdivision& subdivision, const std::vector<CellCause>& causes,
                                           const Placement* placement, const TimeModel& model);

[[nodiscard]] std::uint64_t peak_rss_bytes();

}  // namespace standin
