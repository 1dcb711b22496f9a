// The city's textures and materials, painted with integer arithmetic so that they are the same bytes everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// What a surface of a city model is made of; facades and paints come in several colours, chosen per object.
enum class Surface : std::uint32_t {
  kFacade,
  kPaint,
  kRoof,
  kTrim,
  kBark,
  kLeaves,
  kGlass,
  kTyre,
  kMetal,
  kWood,
  kAsphalt,
  kPaving,
  kGrass,
  kPoster
};

inline constexpr std::uint32_t kFacadeColours = 6;
inline constexpr std::uint32_t kPaintColours = 6;
/// One facade texture shows this many bays and floors.
inline constexpr int kFacadeBays = 4;
inline constexpr int kFacadeFloors = 4;

void add_city_materials(Scene& scene, std::uint64_t seed);

/// Index into Scene::materials; `colour` is used modulo the number of colours of the surface.
[[nodiscard]] std::uint32_t city_material(Surface surface, std::uint32_t colour);

}  // namespace standin
