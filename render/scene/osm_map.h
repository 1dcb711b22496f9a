// The map of a city, out of a folder of OpenStreetMap vector tiles: in metres, cut to the 1.5 x 1.0 km (the thesis' Vienna, 1.6) that
// hold the most floors.
//
// Tiles are files named ZOOM-COLUMN-ROW.mvt. Tag values are those of the OpenStreetMap wiki; what they leave open (most houses have no
// `building:levels`, no street has a width) is filled by one rule each, named below.
#pragma once

#include <filesystem>
#include <vector>

#include "render/scene/region.h"

namespace standin {

inline constexpr Vec2 kMapSize_m{1500.0, 1000.0};

struct MapBuilding {
  Region footprint;
  PlanBox bounds;
  double floors = 1.0;
};

struct MapStreet {
  Path line;
  double width_m = 8.0;
  bool vehicles = true;  // else for people on foot
};

struct StreetMap {
  PlanBox bounds;                      // from (0, 0)
  std::vector<MapBuilding> buildings;  // wholly inside, in the order of the tiles, none mostly within another
  std::vector<MapStreet> streets;      // those that meet the map; not cut
  std::vector<Region> greens;
  std::vector<Region> waters;
};

/// Throws Failure: kFileMissing (no folder, no tile in it), kFileBroken (a file that is no tile, tiles of several zoom levels),
/// kSceneEmpty (no building).
[[nodiscard]] StreetMap read_street_map(const std::filesystem::path& folder);

/// Floors that a building's tags say or suggest: `building:levels`, else a height over 3.3 m, else 1, or 2 from 300 m2 on.
[[nodiscard]] double floors_of(const std::string& levels, const std::string& height, double area_m2);

}  // namespace standin
