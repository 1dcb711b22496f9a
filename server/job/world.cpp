#include "server/job/world.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <thread>

#include "placement/view_space/cell_boxes.h"
#include "render/base/error.h"
#include "render/visibility/occlusion_probe.h"
#include "server/cache/visible_set_cache.h"

namespace standin {
namespace {

// Below this share of hidden triangles, visible sets cannot pay for themselves.
constexpr double kOcclusionWorthwhile = 0.2;

UpAxis up_axis(const std::string& name) {
  if (name == "x") return UpAxis::kX;
  if (name == "y") return UpAxis::kY;
  if (name == "z") return UpAxis::kZ;
  return UpAxis::kAuto;
}

double metres_per_unit(const std::string& unit) {
  if (unit == "auto") return 0.0;
  if (unit == "m") return 1.0;
  if (unit == "cm") return 0.01;
  if (unit == "mm") return 0.001;
  if (unit == "in") return 0.0254;
  char* end = nullptr;
  const double factor = std::strtod(unit.c_str(), &end);
  if (end == unit.c_str() || *end != '\0' || !(factor > 0.0) || !(factor < 1e12))
    throw Failure(ErrorWord::kBadUsage, "--unit " + unit + " violates: auto, m, cm, mm, in or a factor > 0");
  return factor;
}

std::vector<Vec3> read_path(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Failure(ErrorWord::kFileMissing, "path file " + file.string() + " cannot be read");
  std::vector<Vec3> positions;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    Vec3 p{0.0};
    char extra = 0;
    const int fields = std::sscanf(line.c_str(), " %lf , %lf , %lf %c", &p.x, &p.y, &p.z, &extra);
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    if (fields == 3 && finite)
      positions.push_back(p);
    else if (fields > 0 || (number > 1 && line.find_first_not_of(" \t\r") != std::string::npos))
      throw Failure(ErrorWord::kFileBroken, file.string() + ":" + std::to_string(number) + ": \"" + line + "\" is not x,y,z in metres");
  }
  if (positions.empty()) throw Failure(ErrorWord::kViewSpaceEmpty, "path file " + file.string() + " holds no position");
  return positions;
}

ViewSpace make_view_space(const JobSpec& spec, const Scene& scene, const Raytracer& raytracer, const ViewSpaceOptions& options) {
  if (spec.view_space == "boxes") {
    if (spec.boxes.empty()) throw Failure(ErrorWord::kViewSpaceEmpty, "view_space.kind = boxes, but view_space.boxes is empty");
    return make_box_view_space(spec.boxes, options);
  }
  if (spec.view_space.starts_with("path:")) return make_path_view_space(read_path(spec.view_space.substr(5)), spec.path_radius_m, options);
  ViewSpaceKind kind = spec.view_space == "walk" ? ViewSpaceKind::kWalk : ViewSpaceKind::kOrbit;
  std::string why;
  const ViewSpaceKind fitting = default_view_space(scene, why);
  if (spec.view_space == "auto") kind = fitting;
  ViewSpace space = kind == ViewSpaceKind::kWalk ? make_walk_view_space(scene, raytracer, options) : make_orbit_view_space(scene, options);
  if (spec.view_space == "auto")
    space.why = why + "; " + space.why;
  else
    space.why = "asked for; " + space.why + (kind == fitting ? "" : "; auto would have chosen " + why);
  return space;
}

std::vector<Box> boxes_of(const ViewSpace& space, const std::vector<CellKey>& keys) {
  std::vector<Box> boxes;
  boxes.reserve(keys.size());
  const CellBoxes cells(space);
  for (const auto& key : keys) boxes.push_back(cells.cell_box(key));
  return boxes;
}

// Whether to compute visible sets; says why not.
bool wants_visibility(const JobSpec& spec, World& world, const std::vector<Box>& regions, StageClock& clock) {
  if (spec.visibility == "off") {
    clock.leave_out("visibility", "switched off");
    return false;
  }
  const bool asked_for = spec.visibility == "on" || forced(spec, "visibility");
  if (world.scene.objects.size() == 1 && !asked_for) {
    clock.leave_out("visibility", "a single object: nothing can hide it");
    return false;
  }
  world.occlusion = probe_occlusion(world.scene, *world.raytracer, regions, spec.seed);
  if (asked_for || world.occlusion >= kOcclusionWorthwhile) return true;
  const std::string hidden = "a probe found " + std::to_string(static_cast<int>(100.0 * world.occlusion)) + " % of the triangles hidden: ";
  clock.leave_out("visibility", hidden + (world.occlusion > 0.0 ? "visible sets would gain little" : "no occlusion to gain"));
  return false;
}

// Sets that hold every object say nothing.
bool tells_anything(const Visibility& visibility, std::size_t objects) {
  return std::ranges::any_of(visibility.sets, [&](const auto& set) { return set.size() < objects; });
}

VisibilityFigures figures_of(const JobSpec& spec, const World& world, const VisibleSetCache& cache, const std::vector<Box>& regions,
                             const std::vector<VisibleSet>& sets, const WorkBudget& budget) {
  VisibilityFigures figures;
  for (const VisibleSet& set : sets) {
    figures.highest_missed_share = std::max(figures.highest_missed_share, set.missed_share_bound);
    figures.rays += set.rays;
    if (set.missed_share_bound > spec.visibility_missed_share) ++figures.uncertified_cells;
  }
  VisibilityAuditOptions options;
  options.seed = spec.seed;
  const VisibilityAudit audit = cache.audit(regions, sets, world.camera, options, world.threads, budget);
  figures.mean_missed_share = audit.mean_missed_share_bound;
  figures.worst_view_share = audit.worst_view_share;
  figures.views = audit.views;
  return figures;
}

void add_visibility(const JobSpec& spec, World& world, StageCache* stage_cache, StageClock& clock, const WorkBudget& budget) {
  const std::vector<CellKey> keys = leaf_keys(world.view_space);
  const std::vector<Box> regions = boxes_of(world.view_space, keys);
  if (!wants_visibility(spec, world, regions, clock)) return;
  const VisibilityOptions options{spec.visibility_rays, spec.visibility_missed_share, spec.seed};
  const VisibleSetCache cache(stage_cache, world.scene, *world.raytracer);
  auto sets = cache.sets(regions, options, world.threads, budget);
  world.visible_sets = figures_of(spec, world, cache, regions, sets, budget);
  world.visibility.cells = keys;
  for (auto& set : sets) world.visibility.sets.push_back(std::move(set.objects));
  if (!tells_anything(world.visibility, world.scene.objects.size())) world.visibility = {};
}

}  // namespace

LoadOptions load_options(const JobSpec& spec) {
  LoadOptions options;
  options.placing = {up_axis(spec.up), metres_per_unit(spec.unit)};
  options.split_triangles = spec.split_triangles;
  options.split_extent = spec.split_extent;
  options.max_triangles = spec.max_triangles;
  options.max_texels = spec.max_texels;
  options.texture_folders.assign(spec.texture_folders.begin(), spec.texture_folders.end());
  return options;
}

Camera camera_of(const JobSpec& spec) {
  Camera camera;
  camera.fov_y_rad = glm::radians(spec.fov_y_deg);
  camera.width = spec.width;
  camera.height = spec.height;
  return camera;
}

RegionBounds region_bounds(const JobSpec& spec) {
  if (spec.region_bounds == "view") return RegionBounds::kByView;
  return spec.region_bounds == "object" ? RegionBounds::kByObject : RegionBounds::kBySample;
}

void require_bounds(const std::string& command, const JobSpec& spec) {
  if (region_bounds(spec) == RegionBounds::kByView)
    throw Failure(ErrorWord::kBadUsage, "--region-bounds view violates: sample or object, since " + command + " says what can be promised");
}

ViewSpaceOptions view_space_options(const JobSpec& spec) {
  ViewSpaceOptions options;
  options.leaf_m = spec.leaf_m;
  options.refine_levels = spec.refine_levels;
  options.interval_deg = spec.interval_deg;
  options.eye_height_m = spec.eye_height_m;
  options.max_leaves = spec.max_leaves;
  options.bounds = region_bounds(spec);
  return options;
}

BakeQuality quality_of(const JobSpec& spec, ViewSpaceKind view_space) {
  BakeQuality quality;
  quality.alpha_scale = spec.alpha_scale;
  quality.texel_scale = spec.texel_scale;
  quality.fuzzy = spec.fuzzy;
  const std::uint32_t by_view_space = view_space == ViewSpaceKind::kOrbit ? 400 : 200;
  quality.max_layers = spec.max_layers > 0 ? spec.max_layers : by_view_space;
  return quality;
}

int thread_count(const JobSpec& spec) {
  return spec.threads > 0 ? spec.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void build_world(const std::filesystem::path& scene_file, const JobSpec& spec, StageClock& clock, const WorkBudget& budget, World& world,
                 StageCache* cache) {
  world.threads = thread_count(spec);
  world.camera = camera_of(spec);
  world.view_space_options = view_space_options(spec);
  clock.run("load", [&] {
    world.scene = load_scene(scene_file, load_options(spec));
    world.hierarchy = build_hierarchy(world.scene);
  });
  clock.run("view_space", [&] {
    world.raytracer = std::make_unique<Raytracer>(world.scene, Raytracer::Options{true, world.threads});
    world.view_space = make_view_space(spec, world.scene, *world.raytracer, world.view_space_options);
  });
  for (const auto& sentence : world.view_space.left_out) clock.leave_out("view_space", sentence);
  clock.run("visibility", [&] { add_visibility(spec, world, cache, clock, budget); });
  add_lods(spec, world, cache, clock, budget);
  world.quality = quality_of(spec, world.view_space.kind);
  world.quality.leave_out = !forced(spec, "bake");
  if (cache != nullptr) world.bake_cache = std::make_unique<BakeCache>(*cache, world.scene, world.camera, world.quality);
}

}  // namespace standin
