// Geometric levels of detail of a scene's objects: which simpler form may stand for an object, from how far (thesis 5.5.1; 5.2.3: impostors
// are placed only where visibility and levels of detail do not suffice).
//
// An object's own levels (MSFT_lod) are taken as they are; the others' come from simplifying its meshes (simplify_mesh.h). A level is shown
// where its error projects to no more than so many pixels anywhere in the image. A 3D cell decides by its least distance from the object's
// bounds, so that all frames from a cell show the same fixed set, and a smaller cell never a finer one.
//
// level 0: the object's own parts; level k: Object::levels[k - 1].
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"
#include "render/scene/simplify_mesh.h"

namespace standin {

/// What of a camera decides: render/view/level_camera.h.
struct LevelOptions {
  double error_m_per_m = 0.0;         // that may be seen, per metre of distance from the eye
  double whole_image_distance = 0.0;  // in radii: from there a sphere's disc has the area of the image
  int threads = 1;
  bool measure = true;  // false: take meshoptimizer's word for errors, to see quickly whether levels are worth it
};

struct LevelSummary {
  std::uint32_t simplified_meshes = 0;  // that have a level
  std::uint32_t objects = 0;            // that have one, of these:
  std::uint32_t authored_objects = 0;
  std::uint64_t pieces = 0;  // of surface that the error bounds took
};

/// Fills in Object::levels, adding meshes and parts. The same for any number of threads, several of which may call `simplify`.
LevelSummary add_object_levels(Scene& scene, const LevelOptions& options, const WorkBudget& budget, const Simplify& simplify = simplified);

/// A scene before it was given levels, to come back to.
class LevelsAsLoaded {
 public:
  explicit LevelsAsLoaded(const Scene& scene);
  void restore(Scene& scene) const;

 private:
  std::size_t parts_ = 0;
  std::size_t meshes_ = 0;
  std::vector<std::vector<ObjectLevel>> levels_;
};

/// Of the levels of one range of parts, finest first: what drawing one costs, what keeping it costs, how often it is drawn.
struct LevelWorth {
  double triangles = 0.0;
  double bytes = 0.0;
  double shown = 0.0;  // times a frame that a cell shows this very level, if all are kept
};
/// Which to keep, ascending, so that the triangles saved a frame, less `triangles_per_byte` for what is kept, are most. `whole`: triangles
/// of the object's own parts. A frame shows the coarsest kept level that is no coarser than what it might show.
[[nodiscard]] std::vector<std::size_t> levels_worth_keeping(double whole, std::span<const LevelWorth> levels, double triangles_per_byte);

/// Takes away what add_object_levels() or the file gave, so that objects are drawn as they are.
void remove_all_levels(Scene& scene);

/// The coarsest level that may be shown to eyes no nearer to the object's bounds than `distance_m`.
[[nodiscard]] inline std::uint32_t level_at(const Object& object, double distance_m) {
  std::uint32_t level = 0;
  while (level < object.levels.size() && object.levels[level].least_distance_m <= distance_m) ++level;
  return level;
}

/// The level that a cell's frames show.
[[nodiscard]] inline std::uint32_t level_from(const Object& object, const Box& cell) {
  return object.levels.empty() ? 0 : level_at(object, distance(cell, object.bounds));
}

/// Of each of `objects`; empty where all show their own parts.
[[nodiscard]] std::vector<std::uint8_t> levels_from(const Scene& scene, std::span<const std::uint32_t> objects, const Box& cell);

/// What a level draws.
struct LevelParts {
  std::uint32_t first_part = 0;
  std::uint32_t part_count = 0;
  std::uint64_t triangle_count = 0;
};
[[nodiscard]] inline LevelParts parts_of(const Object& object, std::uint32_t level) {
  if (level == 0) return {object.first_part, object.part_count, object.triangle_count};
  const ObjectLevel& drawn = object.levels[level - 1];
  return {drawn.first_part, drawn.part_count, drawn.triangle_count};
}

}  // namespace standin
