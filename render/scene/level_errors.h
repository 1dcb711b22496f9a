// How far levels of detail lie from what they stand for, and from where they may be shown: the rules that levels are made by, and the check
// of levels that somebody states (thesis 5.5.1 shows levels by distance, and asks for no proof).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/work.h"
#include "render/scene/object_levels.h"
#include "render/scene/surface_deviation.h"

namespace standin {

/// The most by which a transform stretches any direction.
[[nodiscard]] double greatest_stretch(const Mat4& transform);
/// Distance from which an author's level is shown, by the share of the image that the object's sphere covers there.
[[nodiscard]] double coverage_distance_m(const Object& object, double screen_coverage, const LevelOptions& options);

struct PartRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  friend auto operator<=>(const PartRange&, const PartRange&) = default;
};
/// As one surface by place alone: texture coordinates of other meshes mean something else.
[[nodiscard]] Surface surface_of_parts(const Scene& scene, PartRange parts);
/// The greater of both ways' deviations; `pieces_per_triangle` of both ranges is the most, each way.
[[nodiscard]] Deviation deviation_by_place(const Scene& scene, PartRange a, PartRange b, DeviationLimits limits,
                                           double pieces_per_triangle);

struct LevelFault {
  std::uint32_t object = 0;
  std::string sentence;
};

/// Bounds the error of every level anew, from its own triangles and those of the scene, whoever made it: a level whose surface lies farther
/// off than stated, or that is shown from nearer than its error or its author's coverage allows, is a fault. Cheaper than finding the
/// error: a piece of surface that lies within what is stated needs no closer look.
[[nodiscard]] std::vector<LevelFault> level_faults(const Scene& scene, const LevelOptions& options, const WorkBudget& budget);

}  // namespace standin
