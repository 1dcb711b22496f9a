#include "server/job/lods.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>

#include "placement/view_space/cell_boxes.h"
#include "render/base/sha256.h"
#include "render/view/level_camera.h"
#include "server/cache/simplified_cache.h"
#include "server/job/world.h"

namespace standin {
namespace {

// Fewer triangles saved are not worth a second file to load and levels to choose.
constexpr double kWorthwhile = 0.05;
constexpr std::size_t kMostCells = 256;
// What a byte must save of a frame's triangles, mean over the leaves (tests/bench/lods.md).
constexpr double kTrianglesPerByte = 0.03;

/// Calls see(object id, level) for all that leaves, spread evenly through the view space, see; returns how many leaves.
template <class See>
std::size_t look_around(const World& world, const See& see) {
  const std::vector<CellKey> keys = leaf_keys(world.view_space);
  const CellBoxes cells(world.view_space);
  std::vector<std::uint32_t> all(world.scene.objects.size());
  std::iota(all.begin(), all.end(), 0U);
  const std::size_t step = std::max<std::size_t>(1, keys.size() / kMostCells);
  std::size_t leaves = 0;
  for (std::size_t c = 0; c < keys.size(); c += step, ++leaves) {
    const Box box = cells.cell_box(keys[c]);
    for (const std::uint32_t id : world.visibility.sets.empty() ? all : world.visibility.sets[c])
      see(id, level_from(world.scene.objects[id], box));
  }
  return leaves;
}

/// Over what leaves see.
double saved_share(const World& world) {
  double whole = 0.0, drawn = 0.0;
  look_around(world, [&](std::uint32_t id, std::uint32_t level) {
    whole += static_cast<double>(world.scene.objects[id].triangle_count);
    drawn += static_cast<double>(parts_of(world.scene.objects[id], level).triangle_count);
  });
  return whole > 0.0 ? 1.0 - drawn / whole : 0.0;
}

double bytes_of(const Scene& scene, const ObjectLevel& level) {
  double bytes = 0.0;
  for (std::uint32_t p = level.first_part; p < level.first_part + level.part_count; ++p) bytes += level_bytes(scene, scene.parts[p]);
  return bytes;
}

/// The parts that an object and its levels begin with: those of instances are the same.
std::vector<std::uint32_t> forms_of(const Object& object) {
  std::vector<std::uint32_t> forms{object.first_part};
  for (const ObjectLevel& level : object.levels) forms.push_back(level.first_part);
  return forms;
}

std::vector<std::size_t> worth_keeping(const Scene& scene, const Object& object, const std::vector<double>& shown) {
  std::vector<LevelWorth> worth;
  for (std::size_t k = 0; k < object.levels.size(); ++k)
    worth.push_back({static_cast<double>(object.levels[k].triangle_count), bytes_of(scene, object.levels[k]), shown[k + 1]});
  return levels_worth_keeping(static_cast<double>(object.triangle_count), worth, kTrianglesPerByte);
}

/// Instances share their levels, so they keep the same ones: what all of them save counts.
void keep_what_is_worth_its_bytes(World& world) {
  std::vector<Object>& objects = world.scene.objects;
  std::map<std::vector<std::uint32_t>, std::vector<double>> shown;  // times a frame by level, the objects' own parts first
  for (const Object& object : objects) shown[forms_of(object)].resize(object.levels.size() + 1);
  std::vector<std::vector<double>*> of_object;
  for (const Object& object : objects) of_object.push_back(&shown[forms_of(object)]);
  const std::size_t leaves = look_around(world, [&](std::uint32_t id, std::uint32_t level) { (*of_object[id])[level] += 1.0; });
  for (auto& [forms, times] : shown)
    for (double& often : times) often /= static_cast<double>(leaves);
  for (std::uint32_t id = 0; id < objects.size(); ++id) {
    std::vector<ObjectLevel> kept;
    for (const std::size_t k : worth_keeping(world.scene, objects[id], *of_object[id])) kept.push_back(objects[id].levels[k]);
    objects[id].levels = std::move(kept);
  }
}

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

/// Simplified without a look at errors, which are mostly greater than meshoptimizer says: so no less is saved, hardly ever.
double share_that_may_be_saved(World& world, LevelOptions options, const Simplify& simplify, const WorkBudget& budget) {
  const LevelsAsLoaded before(world.scene);
  options.measure = false;
  (void)add_object_levels(world.scene, options, budget, simplify);
  const double share = saved_share(world);
  before.restore(world.scene);
  return share;
}

std::string too_little(double share) {
  return "simpler meshes would save " + percent(share) + " of the triangles at the distances of the view space";
}

/// Writes the levels and goes on with what the file holds, as everybody does who reads it.
void ship(const LevelsAsLoaded& before, World& world) {
  LodFigures& lods = world.lods;
  lods.file = write_levels(world.scene);
  lods.sha256 = sha256_hex(lods.file.glb);
  const std::vector<StatedLevel> stated = stated_levels(world.scene);
  before.restore(world.scene);
  (void)read_levels(stated, lods.file.glb, world.scene);
}

bool has_levels(const Object& object) {
  return !object.levels.empty();
}

/// Says why not, where levels are not worth it.
std::string give_levels(const JobSpec& spec, World& world, const Simplify& simplify, const WorkBudget& budget) {
  const LevelOptions options = level_options(spec, world.camera, world.threads);
  const bool asked_for = spec.lods == "on";
  if (!asked_for && !forced(spec, "lods"))
    if (const double share = share_that_may_be_saved(world, options, simplify, budget); share < kWorthwhile)
      return "a probe found that " + too_little(share);
  LodFigures& lods = world.lods;
  const LevelsAsLoaded before(world.scene);
  lods.levels = add_object_levels(world.scene, options, budget, simplify);
  if (lods.levels.objects == 0) return "no object has a simpler form";
  keep_what_is_worth_its_bytes(world);
  lods.levels.objects = static_cast<std::uint32_t>(std::ranges::count_if(world.scene.objects, has_levels));
  lods.saved_share = saved_share(world);
  if (lods.levels.objects == 0) return "simpler meshes would weigh more than they save";
  if (lods.saved_share < kWorthwhile && !asked_for) return too_little(lods.saved_share);
  lods.used = true;
  ship(before, world);
  return "";
}

}  // namespace

LevelOptions level_options(const JobSpec& spec, const Camera& camera, int threads) {
  return {error_m_per_m(camera, spec.lods_error_px), whole_image_distance(camera), threads};
}

void leave_lods_out(const std::string& why, const JobSpec& spec, World& world, StageClock& clock) {
  remove_all_levels(world.scene);
  world.lods.used = false;
  world.lods.file = {};
  world.lods.sha256.clear();
  if (!forced(spec, "lods")) clock.leave_out("lods", why);
}

void add_lods(const JobSpec& spec, World& world, StageCache* cache, StageClock& clock, const WorkBudget& budget) {
  if (spec.lods == "off") return remove_all_levels(world.scene);
  const std::string why_not = clock.run("lods", [&] { return give_levels(spec, world, simplified_through(cache), budget); });
  if (!world.lods.used) leave_lods_out(why_not, spec, world, clock);
}

nlohmann::json lods_json(const LodFigures& figures) {
  return {{"used", figures.used},
          {"objects", figures.levels.objects},
          {"authored_objects", figures.levels.authored_objects},
          {"simplified_meshes", figures.levels.simplified_meshes},
          {"saved_triangles_share", figures.saved_share},
          {"bytes", figures.file.buffer_bytes},
          {"file_bytes", figures.file.glb.size()}};
}

}  // namespace standin
