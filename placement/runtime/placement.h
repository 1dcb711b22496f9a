// The placement as a renderer uses it: for any view, which impostors and which originals to draw. The in-memory form of placement.json, and
// the lookup that verification uses is the one that ships.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "placement/view_space/cell_locator.h"
#include "placement/view_space/view_space.h"
#include "render/impostor/impostor.h"
#include "render/scene/scene.h"
#include "render/view/direction_interval.h"

namespace standin {

struct PlacementCell {
  CellKey key;
  Box box;
  std::int32_t visible_set = -1;  // -1: all objects
};

struct PlacementCpv {
  std::uint32_t cell = 0;
  std::uint32_t interval = 0;
  double bound_before_ms = 0.0;
  double bound_after_ms = 0.0;
  bool solved = false;
  std::vector<std::uint32_t> impostors;  // ascending; they stand for disjoint sets of objects
};

struct PlacementImpostor {
  std::string technique = "layered";
  std::string guarantee = "nearest";  // texture filtering for which images keep their promise; "none": a fuzzy impostor's do not
  std::vector<std::uint32_t> objects;
  ViewCell view_cell;
  ImpostorFrame frame;
  std::vector<Layer> layers;
  std::uint32_t quads = 0;   // two triangles each
  std::uint64_t texels = 0;  // that its triangles cover (ImpostorCost)
  std::uint64_t texture_bytes = 0;
  std::uint64_t geometry_bytes = 0;
  double time_bound_ms = 0.0;  // at the nearest point of its view cell
};

/// From how far an object's simpler forms are shown (render/scene/object_levels.h): by the least distance of a cell from its bounds.
struct PlacementLevels {
  std::uint32_t object = 0;
  Box bounds;
  std::vector<double> least_distance_m;        // of levels 1, 2 ..., ascending
  std::optional<Mat4> world_from_object = {};  // of their vertices; none: the scene file's node, whose vertices they are, says it
  [[nodiscard]] std::uint8_t level_from(const Box& cell) const;
};

/// Of all objects that have levels.
[[nodiscard]] std::vector<PlacementLevels> placement_levels(const Scene& scene);

struct Placement {
  std::vector<PlacementCell> cells;          // sorted by key
  std::vector<DirectionInterval> intervals;  // sorted
  std::vector<PlacementCpv> cpvs;            // sorted by (cell, interval)
  std::vector<std::vector<std::uint32_t>> visible_sets;
  std::vector<PlacementImpostor> impostors;
  std::vector<PlacementLevels> levels;  // sorted by object; objects without levels left out
  Vec3 root_min{0.0};                   // of the dyadic grid
  double root_side_m = 0.0;
};

/// A placement in the form of the lookup that ships (runtime/placement_lookup.h). find() allocates nothing and may be called from several
/// threads.
class PlacementIndex {
 public:
  /// Throws Failure(kFileBroken) naming the entry when cells, intervals or CPVs are out of order or refer to nothing.
  explicit PlacementIndex(const Placement& placement);
  /// The direction's length does not matter; one without length has no CPV.
  [[nodiscard]] Lookup find(const Vec3& position, const Vec3& direction) const;

 private:
  CellLocator cells_;
  std::vector<LookupInterval> intervals_;
  std::vector<LookupCpv> cpvs_;
  std::uint32_t interval_levels_ = 0;
};

/// Objects to draw as originals and impostors to draw, for a lookup's answer. `object_count` of the scene.
struct ViewContent {
  std::vector<std::uint32_t> objects;    // ascending
  std::vector<std::uint32_t> impostors;  // ascending
  std::vector<std::uint8_t> levels;      // of detail of `objects`; empty: all show their own parts
};
[[nodiscard]] ViewContent content_of(const Placement& placement, const Lookup& lookup, std::uint32_t object_count);

}  // namespace standin
