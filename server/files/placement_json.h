// placement.json: the runtime contract (architecture.md; configs/placement.schema.json settles the names).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/view_space.h"
#include "render/scene/level_file.h"
#include "render/scene/scene.h"
#include "server/job/job_spec.h"

namespace standin {

/// A placement with what is needed to use and to re-score it.
struct PlacementFile {
  JobSpec spec;
  std::string scene_name;
  std::string scene_sha256;
  std::string target_id;
  std::string target_sha256;
  double coverage = 0.0;
  Camera camera;
  ViewSpace view_space;
  std::uint32_t atlas_pages = 0;  // a texture switch each, charged to every region that draws an impostor
  Placement placement;
  std::string lods_sha256;             // of lods.glb; empty where no levels of detail are shown
  std::vector<StatedLevel> lods = {};  // as read; written are those of the scene
};

[[nodiscard]] nlohmann::json placement_to_json(const PlacementFile& file, const Scene& scene);
/// Throws Failure(kFileBroken) naming the file and what is wrong with it.
[[nodiscard]] PlacementFile placement_from_json(const nlohmann::json& object, const std::string& name);

}  // namespace standin
