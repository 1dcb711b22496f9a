// A real city: the buildings and streets of an OpenStreetMap extract, with real trees, cars and lamps along them.
//
// The generated city (city.h) repeats twelve houses on a grid; here every building has its own footprint, streets bend and yards are
// open, so that methods tuned to the grid are found out. Heavy parts are instanced: few meshes, thousands of objects.
#pragma once

#include <cstdint>
#include <filesystem>

#include "render/scene/scene.h"

namespace standin {

struct RealCityOptions {
  std::filesystem::path osm;             // folder of vector tiles (osm_map.h)
  std::filesystem::path furniture;       // folder of unpacked catalogues (street_models.h)
  std::uint32_t objects = 5287;          // fewer where the streets have no room for so many
  std::uint64_t triangles = 10'400'000;  // drawn, at least; fewer where there is no room
  std::uint64_t seed = 1;
};

/// Throws Failure: what read_street_map and add_street_models throw, and kBadUsage where buildings and ground alone are more objects.
[[nodiscard]] Scene make_real_city(const RealCityOptions& options);

}  // namespace standin
