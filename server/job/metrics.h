// Parts of metrics.json that need more than a copy: heat map, causes. Units in the key names, as everywhere in that file.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/subdivision.h"
#include "placement/view_space/survey.h"
#include "server/job/world.h"

namespace standin {

/// The slowest views that a survey found, one a cell, slowest first; frame_ms is estimated.
[[nodiscard]] nlohmann::json slow_views_json(const std::vector<SlowView>& slow);
/// Their views, from metrics.json's survey.worst_views.
[[nodiscard]] std::vector<View> slow_views_from_json(const nlohmann::json& worst_views);

/// Per cell in plan view: the highest bound of any direction, before and (where there is a placement) after; and, of a cell with problem
/// views, the cause of the slowest: shares of draws, triangles and pixels, and its three dearest objects.
[[nodiscard]] nlohmann::json heat_map_json(const World& world, const Subdivision& subdivision, const Placement* placement,
                                           const TimeModel& model);

/// What makes the slowest region of each cell slow: predicted milliseconds by draws, triangles and pixels, and the objects that cost most,
/// summed over these regions.
[[nodiscard]] nlohmann::json causes_json(const World& world, const Subdivision& subdivision, const TimeModel& model);

/// The `count` largest terms, largest first; ties by object id.
[[nodiscard]] std::vector<RegionTerm> largest_terms(std::vector<RegionTerm> terms, std::size_t count);
/// [{object, name, ms}]
[[nodiscard]] nlohmann::json objects_json(const World& world, const std::vector<RegionTerm>& terms);

[[nodiscard]] std::uint64_t peak_rss_bytes();

}  // namespace standin
