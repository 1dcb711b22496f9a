#include "server/job/lods.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "placement/view_space/cell_boxes.h"
#include "render/base/sha256.h"
#include "render/scene/load.h"
#include "render/view/level_camera.h"
#include "server/job/world.h"

namespace standin {
namespace {

// Fewer triangles saved are not worth a second file to load and levels to choose.
constexpr double kWorthwhile = 0.05;
constexpr std::size_t kMostCells = 256;

/// Over leaves spread evenly through the view space, each with what is visible from it.
double saved_share(const World& world) {
  const std::vector<CellKey> keys = leaf_keys(world.view_space);
  const CellBoxes cells(world.view_space);
  std::vector<std::uint32_t> all(world.scene.objects.size());
  std::iota(all.begin(), all.end(), 0U);
  double whole = 0.0, drawn = 0.0;
  const std::size_t step = std::max<std::size_t>(1, keys.size() / kMostCells);
  for (std::size_t c = 0; c < keys.size(); c += step) {
    const Box box = cells.cell_box(keys[c]);
    for (const std::uint32_t id : world.visibility.sets.empty() ? all : world.visibility.sets[c]) {
      const Object& object = world.scene.objects[id];
      whole += static_cast<double>(object.triangle_count);
      drawn += static_cast<double>(parts_of(object, level_from(object, box)).triangle_count);
    }
  }
  return whole > 0.0 ? 1.0 - drawn / whole : 0.0;
}

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

/// Simplified without a look at errors, which are mostly greater than meshoptimizer says: so no less is saved, hardly ever.
double share_that_may_be_saved(World& world, LevelOptions options, const WorkBudget& budget) {
  options.measure = false;
  (void)add_object_levels(world.scene, options, budget);
  const double share = saved_share(world);
  remove_simplified_levels(world.scene);
  return share;
}

std::string too_little(double share) {
  return "simpler meshes would save " + percent(share) + " of the triangles at the distances of the view space";
}

/// Says why not, where levels are not worth it.
std::string give_levels(const JobSpec& spec, World& world, const WorkBudget& budget) {
  const LevelOptions options = level_options(spec, world.camera, world.threads);
  const bool asked_for = spec.lods == "on";
  if (!asked_for && !forced(spec, "lods"))
    if (const double share = share_that_may_be_saved(world, options, budget); share < kWorthwhile)
      return "a probe found that " + too_little(share);
  LodFigures& lods = world.lods;
  lods.levels = add_object_levels(world.scene, options, budget);
  lods.saved_share = saved_share(world);
  if (lods.levels.objects == 0) return "no object has a simpler form";
  if (lods.saved_share < kWorthwhile && !asked_for) return too_little(lods.saved_share);
  lods.used = true;
  lods.glb = scene_glb(scene_of_levels(world.scene));
  lods.sha256 = sha256_hex(lods.glb);
  return "";
}

}  // namespace

LevelOptions level_options(const JobSpec& spec, const Camera& camera, int threads) {
  return {error_m_per_m(camera, spec.lods_error_px), whole_image_distance(camera), threads};
}

void add_lods(const JobSpec& spec, World& world, StageClock& clock, const WorkBudget& budget) {
  if (spec.lods == "off") return remove_all_levels(world.scene);
  const std::string why_not = clock.run("lods", [&] { return give_levels(spec, world, budget); });
  if (world.lods.used) return;
  remove_all_levels(world.scene);
  if (!forced(spec, "lods")) clock.leave_out("lods", why_not);
}

nlohmann::json lods_json(const LodFigures& figures) {
  return {{"used", figures.used},
          {"objects", figures.levels.objects},
          {"authored_objects", figures.levels.authored_objects},
          {"simplified_meshes", figures.levels.simplified_meshes},
          {"saved_triangles_share", figures.saved_share},
          {"bytes", figures.glb.size()}};
}

}  // namespace standin
