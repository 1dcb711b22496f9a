// A job's levels of detail: whether the scene gains by them, and the file that ships them (thesis 5.5.1).
//
// A quick look decides: simplified without measuring errors, how many triangles fewer do the view space's cells show? Only where that is
// worth it are errors bounded. Of the levels then made those stay that save a frame more triangles than their bytes are worth; the file is
// written, and read again: the job goes on with what it holds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "render/scene/level_file.h"
#include "render/scene/object_levels.h"
#include "render/view/camera.h"
#include "server/job/job_spec.h"
#include "server/job/stage_clock.h"

namespace standin {

class StageCache;
struct World;

struct LodFigures {
  bool used = false;
  LevelSummary levels;
  double saved_share = 0.0;  // of the triangles that cells show, mean over the view space's leaves
  LevelFile file;            // lods.glb; empty where no levels are used
  std::string sha256;        // of it
};

[[nodiscard]] LevelOptions level_options(const JobSpec& spec, const Camera& camera, int threads);
/// Stage lods: gives the world's scene its levels, or takes away those it came with. Needs the view space and the visible sets. `cache`: of
/// simplified meshes, or none.
void add_lods(const JobSpec& spec, World& world, StageCache* cache, StageClock& clock, const WorkBudget& budget);
/// Takes the levels away again, and says why.
void leave_lods_out(const std::string& why, const JobSpec& spec, World& world, StageClock& clock);
/// metrics.json: lods
[[nodiscard]] nlohmann::json lods_json(const LodFigures& figures);

}  // namespace standin
