#include "render/scene/object_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "render/base/parallel.h"
#include "render/scene/level_errors.h"
#include "render/scene/shared_borders.h"
#include "render/scene/surface_deviation.h"
#include "render/scene/textured_surface.h"

namespace standin {
namespace {

// A level of an object must save this share of the next finer one's triangles.
constexpr double kLeastSaving = 0.2;
// Levels are numbered by one byte.
constexpr std::size_t kMostLevels = 255;
// Accuracy of the error of levels whose author says nothing about it.
constexpr double kAuthoredPieces = 200.0;  // per triangle
constexpr double kAuthoredSlack = 1e-4;    // of the diagonal of the object's own parts

/// A mesh's simpler forms, as meshes of the scene.
struct MeshLevel {
  std::uint32_t mesh = 0;
  double error_m = 0.0;
};

/// A level of a range of parts, in mesh space.
struct RangeLevel {
  std::uint32_t first_part = 0;
  std::uint64_t triangle_count = 0;
  double error_m = 0.0;
};

class LevelMaker {
 public:
  LevelMaker(Scene& scene, const LevelOptions& options, const WorkBudget& budget, const Simplify& simplify)
      : scene_(scene), options_(options), budget_(budget), simplify_(simplify) {}

  LevelSummary run() {
    simplify_meshes();
    measure_authored();
    std::map<PartRange, std::vector<RangeLevel>> of_range;
    for (Object& object : scene_.objects) {
      if (!object.levels.empty()) {
        take_authored(object);
        continue;
      }
      const PartRange range{object.first_part, object.part_count};
      const auto [known, fresh] = of_range.try_emplace(range);
      if (fresh) known->second = levels_of(range);
      take(known->second, object);
    }
    for (const Object& object : scene_.objects) summary_.objects += object.levels.empty() ? 0 : 1;
    return summary_;
  }

 private:
  void simplify_meshes() {
    std::set<std::uint32_t> used;
    for (const Object& object : scene_.objects)
      for (std::uint32_t p = 0; object.levels.empty() && p < object.part_count; ++p) used.insert(scene_.parts[object.first_part + p].mesh);
    const std::vector<std::uint32_t> meshes(used.begin(), used.end());
    const std::vector<bool> shared = borders_shared(scene_, options_.threads, budget_);
    const std::vector<bool> textured = worn_with_texture(scene_);
    std::vector<std::vector<SimplifiedMesh>> simple(meshes.size());
    parallel_for(meshes.size(), options_.threads, budget_, [&](std::size_t i) {
      SimplifyOptions options;
      options.measure = options_.measure;
      options.lock_border = shared[meshes[i]];
      options.textured = textured[meshes[i]];
      options.budget = &budget_;
      simple[i] = simplify_(scene_.meshes[meshes[i]], options);
    });
    for (std::size_t i = 0; i < meshes.size(); ++i) add_meshes(meshes[i], simple[i]);
  }

  void add_meshes(std::uint32_t mesh, std::vector<SimplifiedMesh>& simple) {
    if (!simple.empty()) ++summary_.simplified_meshes;
    for (SimplifiedMesh& one : simple) {
      summary_.pieces += one.pieces;
      mesh_levels_[mesh].push_back({static_cast<std::uint32_t>(scene_.meshes.size()), one.error_m});
      one.mesh.simplified_from = static_cast<std::int32_t>(mesh);
      scene_.meshes.push_back(std::move(one.mesh));
    }
  }

  /// For each error that some part has a form of: each part's coarsest form of no greater error.
  std::vector<RangeLevel> levels_of(const PartRange& range) {
    std::set<double> errors;
    for (std::uint32_t p = 0; p < range.count; ++p)
      for (const MeshLevel& level : mesh_levels_[scene_.parts[range.first + p].mesh]) errors.insert(level.error_m);
    std::vector<RangeLevel> levels;
    std::uint64_t fewest = triangles_of(range);
    for (const double error_m : errors) {
      const std::vector<Part> parts = parts_within(range, error_m);
      std::uint64_t triangles = 0;
      for (const Part& part : parts) triangles += scene_.meshes[part.mesh].triangle_count();
      if (static_cast<double>(triangles) > (1.0 - kLeastSaving) * static_cast<double>(fewest)) continue;
      fewest = triangles;
      levels.push_back({static_cast<std::uint32_t>(scene_.parts.size()), triangles, error_m});
      scene_.parts.insert(scene_.parts.end(), parts.begin(), parts.end());
    }
    return levels;
  }

  [[nodiscard]] std::vector<Part> parts_within(const PartRange& range, double error_m) {
    std::vector<Part> parts;
    for (std::uint32_t p = 0; p < range.count; ++p) {
      Part part = scene_.parts[range.first + p];
      for (const MeshLevel& level : mesh_levels_[scene_.parts[range.first + p].mesh])
        if (level.error_m <= error_m) part.mesh = level.mesh;
      parts.push_back(part);
    }
    return parts;
  }

  [[nodiscard]] std::uint64_t triangles_of(const PartRange& range) const {
    std::uint64_t sum = 0;
    for (std::uint32_t p = 0; p < range.count; ++p) sum += scene_.meshes[scene_.parts[range.first + p].mesh].triangle_count();
    return sum;
  }

  void take(const std::vector<RangeLevel>& levels, Object& object) const {
    const double stretch = greatest_stretch(object.world_from_object);
    for (const RangeLevel& level : levels) {
      const double error_m = stretch * level.error_m;
      object.levels.push_back({level.first_part, object.part_count, level.triangle_count, error_m, -1.0, error_m / options_.error_m_per_m});
    }
  }

  /// Those that are simpler than what comes before them, from where their author or their error says.
  void take_authored(Object& object) {
    std::vector<ObjectLevel> kept;
    std::uint64_t fewest = object.triangle_count;
    std::uint32_t fewest_parts = object.part_count;
    for (ObjectLevel level : object.levels) {
      level.triangle_count = triangles_of({level.first_part, level.part_count});
      if (level.triangle_count >= fewest || level.part_count > fewest_parts) continue;
      if (level.screen_coverage < 0.0)
        level.error_m = greatest_stretch(object.world_from_object) * authored_error_m_.at(authored(object, level));
      level.least_distance_m = level.screen_coverage >= 0.0 ? coverage_distance_m(object, level.screen_coverage, options_)
                                                            : level.error_m / options_.error_m_per_m;
      while (!kept.empty() && kept.back().least_distance_m >= level.least_distance_m) kept.pop_back();
      if (kept.size() == kMostLevels) break;
      fewest = level.triangle_count;
      fewest_parts = level.part_count;
      kept.push_back(level);
    }
    object.levels = std::move(kept);
    if (!object.levels.empty()) ++summary_.authored_objects;
  }

  /// An object's own parts, and those of a level of which its author says nothing.
  struct Authored {
    PartRange own, level;
    friend auto operator<=>(const Authored&, const Authored&) = default;
  };
  static Authored authored(const Object& object, const ObjectLevel& level) {
    return {{object.first_part, object.part_count}, {level.first_part, level.part_count}};
  }

  /// Once for all instances.
  void measure_authored() {
    std::set<Authored> found;
    for (const Object& object : scene_.objects)
      for (const ObjectLevel& level : object.levels)
        if (const Authored pair = authored(object, level); level.screen_coverage < 0.0 && triangles_of(pair.level) < object.triangle_count)
          found.insert(pair);
    const std::vector<Authored> pairs(found.begin(), found.end());
    std::vector<Deviation> off(pairs.size());
    parallel_for(pairs.size(), options_.threads, budget_, [&](std::size_t i) { off[i] = authored_deviation(pairs[i]); });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      authored_error_m_[pairs[i]] = off[i].bound_m;
      summary_.pieces += off[i].pieces;
    }
  }

  [[nodiscard]] Deviation authored_deviation(const Authored& pair) const {
    Box bounds;
    for (std::uint32_t p = 0; p < pair.own.count; ++p) bounds.extend(scene_.meshes[scene_.parts[pair.own.first + p].mesh].bounds);
    DeviationLimits limits;
    limits.absolute_m = kAuthoredSlack * bounds.diagonal();
    limits.budget = &budget_;
    return deviation_by_place(scene_, pair.own, pair.level, limits, kAuthoredPieces);
  }

  Scene& scene_;
  const LevelOptions& options_;
  const WorkBudget& budget_;
  const Simplify& simplify_;
  LevelSummary summary_;
  std::map<std::uint32_t, std::vector<MeshLevel>> mesh_levels_;
  std::map<Authored, double> authored_error_m_;  // in the space of the meshes
};

}  // namespace

LevelsAsLoaded::LevelsAsLoaded(const Scene& scene) : parts_(scene.parts.size()), meshes_(scene.meshes.size()) {
  for (const Object& object : scene.objects) levels_.push_back(object.levels);
}

void LevelsAsLoaded::restore(Scene& scene) const {
  scene.parts.resize(parts_);
  scene.meshes.resize(meshes_);
  for (std::size_t id = 0; id < levels_.size(); ++id) scene.objects[id].levels = levels_[id];
}

// By dynamic programming over the finer neighbour that is kept: best[k] is the most that levels before k and k itself are worth.
std::vector<std::size_t> levels_worth_keeping(double whole, std::span<const LevelWorth> levels, double triangles_per_byte) {
  std::vector<double> best(levels.size() + 1, 0.0);
  std::vector<std::size_t> finer(levels.size() + 1, 0);  // 0: the object's own parts
  double shown = 0.0;
  std::vector<double> shown_from(levels.size() + 1, 0.0);
  for (std::size_t k = levels.size(); k > 0; --k) shown_from[k] = shown += levels[k - 1].shown;
  std::size_t last = 0;
  for (std::size_t k = 1; k <= levels.size(); ++k) {
    best[k] = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < k; ++i) {
      const double saved = (i == 0 ? whole : levels[i - 1].triangles) - levels[k - 1].triangles;
      const double worth = best[i] + shown_from[k] * saved - triangles_per_byte * levels[k - 1].bytes;
      if (worth > best[k]) {
        best[k] = worth;
        finer[k] = i;
      }
    }
    if (best[k] > best[last]) last = k;
  }
  std::vector<std::size_t> kept;
  for (std::size_t k = last; k > 0; k = finer[k]) kept.insert(kept.begin(), k - 1);
  return kept;
}

void remove_all_levels(Scene& scene) {
  for (Object& object : scene.objects) object.levels.clear();
}

std::vector<std::uint8_t> levels_from(const Scene& scene, std::span<const std::uint32_t> objects, const Box& cell) {
  std::vector<std::uint8_t> levels;
  bool any = false;
  for (const std::uint32_t object : objects) {
    levels.push_back(static_cast<std::uint8_t>(level_from(scene.objects[object], cell)));
    any = any || levels.back() > 0;
  }
  return any ? levels : std::vector<std::uint8_t>();
}

LevelSummary add_object_levels(Scene& scene, const LevelOptions& options, const WorkBudget& budget, const Simplify& simplify) {
  return LevelMaker(scene, options, budget, simplify).run();
}

}  // namespace standin
