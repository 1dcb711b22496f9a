// Where trees, cars and small things may stand in a mapped city: along its streets, in its greens, never in a house, on a carriageway (but
// for cars, which are parked at its edge) or in one another.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/osm_map.h"
#include "render/scene/real_city_parts.h"

namespace standin {

struct Spot {
  Vec2 place{0.0};
  double yaw_rad = 0.0;  // turns +z along the street
  double scale = 1.0;
};

/// In a seeded order: take from the front.
struct Spots {
  std::vector<Spot> trees;
  std::vector<Spot> cars;
  std::vector<Spot> small;
};

/// What the ground of the map is covered with: carriageways with pavements beside them, paths, paved strips around houses, water, grass.
[[nodiscard]] Ground lay_ground(const StreetMap& map);

[[nodiscard]] Spots find_spots(const StreetMap& map, const Ground& ground, std::uint64_t seed);

}  // namespace standin
