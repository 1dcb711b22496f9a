// What makes slow regions slow: predicted milliseconds by draws, triangles and pixels, and the objects that cost most (thesis 5.5.1: a
// region's bound is a sum over its objects). Of each cell its slowest problem view is looked at.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "estimation/time_model.h"
#include "placement/view_space/subdivision.h"
#include "render/base/work.h"
#include "server/job/world.h"

namespace standin {

struct CauseShares {
  double draws_ms = 0.0, triangles_ms = 0.0, pixels_ms = 0.0;

  void add(const Features& features, const TimeModel& model, bool pixels_capped);
  void add(const CauseShares& other);
  /// draws_share, triangles_share, pixels_share: of their sum.
  [[nodiscard]] nlohmann::json to_json() const;
};

struct CellCause {
  std::uint32_t cell = 0;  // of Subdivision::cells
  CauseShares shares;
  std::span<const RegionTerm> terms;  // of the region; they belong to the subdivision
};

/// Of each cell that has a problem view, ascending by cell.
[[nodiscard]] std::vector<CellCause> causes_per_cell(const World& world, const Subdivision& subdivision, const TimeModel& model,
                                                     const WorkBudget& budget);
/// One cell's: its shares, and its three dearest objects.
[[nodiscard]] nlohmann::json cause_json(const World& world, const CellCause& cause);
/// All cells' together: shares of their sums, and the objects that cost most in all.
[[nodiscard]] nlohmann::json causes_json(const World& world, const std::vector<CellCause>& causes);

/// The `count` largest terms, largest first; ties by object id.
[[nodiscard]] std::vector<RegionTerm> largest_terms(std::vector<RegionTerm> terms, std::size_t count);
/// [{object, name, ms}]
[[nodiscard]] nlohmann::json objects_json(const World& world, const std::vector<RegionTerm>& terms);

}  // namespace standin
