// Scores any given placement from scratch: is every promise of placement.json kept, and if not, which and where.
//
// It trusts nothing but the scene, the model and the boxes of the view space: bounds are recomputed per region, every leaf region that no
// CPV lists is bounded too. It is the evaluator of the optimizer, the regression tool and the user's trust.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/view_space.h"
#include "render/base/work.h"
#include "render/scene/object_levels.h"

namespace standin {

enum class Violation {
  kCellBox,        // a cell's box is not the view space's part inside its cube
  kBoundBefore,    // bound_before_ms is not the recomputed bound
  kBoundAfter,     // bound_after_ms is not the recomputed bound
  kOverBudget,     // a CPV called solved is over budget
  kNotSolved,      // a CPV within the budget is called unsolved
  kNotDisjoint,    // two impostors of a CPV stand for the same object
  kNotEnclosed,    // a CPV's cell is not inside its impostor's view cell
  kMissingRegion,  // a leaf region over budget that no CPV lists
  kLevels,  // an object's levels of detail lie farther off than stated, are shown from too near, or from other bounds than the scene's
  kLayerInViewCell,  // an eye in an impostor's view cell may reach one of its layers: it has no bound
};
[[nodiscard]] const char* violation_name(Violation violation);

struct CheckFinding {
  Violation violation = Violation::kCellBox;
  std::uint32_t index = 0;  // CPV; cell for kCellBox and kMissingRegion; impostor for kLayerInViewCell; object for kLevels
  std::string sentence;     // values, place and the violated constraint
};

struct CheckInput {
  const Scene& scene;
  const std::vector<std::uint32_t>& hierarchy_rank;
  const TimeModel& model;
  const Camera& camera;
  const ViewSpace& view_space;
  const ViewSpaceOptions& view_space_options;
  double budget_ms;
  std::uint32_t atlas_pages;  // a texture switch each, charged to every region that draws an impostor
  LevelOptions levels = {};   // where the scene has levels of detail: those of the placement's file
};

struct CheckReport {
  std::uint32_t cpvs = 0;
  std::uint32_t solved = 0;
  std::uint64_t regions = 0;  // leaf regions looked at
  std::uint64_t texture_bytes = 0;
  std::uint64_t geometry_bytes = 0;
  double worst_bound_after_ms = 0.0;   // over all CPVs
  double levels_s = 0.0;               // that bounding the errors of levels of detail took
  std::vector<CheckFinding> findings;  // by impostor, then cell and its CPVs; empty: the placement keeps its promises
};

[[nodiscard]] CheckReport check_placement(const CheckInput& input, const Placement& placement, int threads, const WorkBudget& budget);

}  // namespace standin
