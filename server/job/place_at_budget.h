// From a surveyed scene and a budget's problem views to impostors and the placement that ships (thesis 5.6 and 5.7): candidates, selection,
// baking, assembly. `place` runs it once, `sweep` once for each budget; both get the same bytes.
#pragma once

#include <string>

#include "render/impostor/impostor.h"
#include "server/files/placement_json.h"
#include "server/job/select_and_bake.h"
#include "server/job/surveyed_scene.h"

namespace standin {

struct Placed {
  Subdivision subdivision;
  bool shows_levels = false;  // of detail
  CandidateSet candidates;
  SelectedImpostors selected;
  Placement placement;
  ImpostorSet set;
  std::string glb;
};

/// Fills all of `placed` but its subdivision and whether it shows levels of detail, which it goes on from. `bakes`: shared with other
/// budgets, or none.
void place_at_budget(const Surveyed& job, const JobSpec& spec, Placed& placed, BakeMemory* bakes, StageClock& clock,
                     const WorkBudget& budget);

/// What placement.json holds.
[[nodiscard]] PlacementFile placement_file(const Surveyed& job, const Placed& placed, const JobSpec& spec);

}  // namespace standin
