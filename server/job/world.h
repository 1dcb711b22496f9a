// What a job looks at: the scene, its hierarchy, the camera, the view space and what is visible from it.
#pragma once

#include <filesystem>
#include <memory>

#include "placement/view_space/subdivision.h"
#include "placement/view_space/view_space.h"
#include "render/impostor/bake.h"
#include "render/scene/hierarchy.h"
#include "render/scene/load.h"
#include "render/visibility/raytracer.h"
#include "server/cache/bake_cache.h"
#include "server/job/job_spec.h"
#include "server/job/lods.h"
#include "server/job/stage_clock.h"

namespace standin {

[[nodiscard]] LoadOptions load_options(const JobSpec& spec);
[[nodiscard]] Camera camera_of(const JobSpec& spec);
[[nodiscard]] RegionBounds region_bounds(const JobSpec& spec);
/// Throws Failure(kBadUsage) where only sampled views are asked for: `command` says how low a budget can be promised, which they do not.
void require_bounds(const std::string& command, const JobSpec& spec);
[[nodiscard]] ViewSpaceOptions view_space_options(const JobSpec& spec);
/// `view_space` decides the default cap on layers.
[[nodiscard]] BakeQuality quality_of(const JobSpec& spec, ViewSpaceKind view_space);
[[nodiscard]] int thread_count(const JobSpec& spec);

/// How good the cells' visible sets are, and what they cost.
struct VisibilityFigures {
  double highest_missed_share = 0.0;    // certified for each cell at 99 %, of uniform rays
  double mean_missed_share = 0.0;       // certified for the mean over the cells at 99 %
  double worst_view_share = 0.0;        // of pixels, in the worst of the sampled views
  std::uint64_t views = 0;              // sampled for it
  std::uint64_t rays = 0;               // that the sets took, all cells together
  std::uint64_t uncertified_cells = 0;  // whose rays were used up before the missed share asked for was certified
};

/// Stays where it is: the raytracer refers to the scene.
struct World {
  World() = default;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  Scene scene;
  Hierarchy hierarchy;
  Camera camera;
  ViewSpaceOptions view_space_options;
  std::unique_ptr<Raytracer> raytracer;
  ViewSpace view_space;
  Visibility visibility;   // empty: left out
  double occlusion = 0.0;  // what the probe found, 0..1
  VisibilityFigures visible_sets;
  LodFigures lods;
  BakeQuality quality;
  std::unique_ptr<BakeCache> bake_cache;  // none: what is baked is forgotten
  int threads = 1;
};

/// Stages load, view_space, visibility and lods. `cache`: of visible sets, simplified meshes and bakes, or none.
void build_world(const std::filesystem::path& scene_file, const JobSpec& spec, StageClock& clock, const WorkBudget& budget, World& world,
                 StageCache* cache = nullptr);

}  // namespace standin
