// The meshes that the real city makes itself: extruded buildings and pieces of ground, with the surfaces of the generated city.
#pragma once

#include "render/scene/city_parts.h"
#include "render/scene/region.h"

namespace standin {

/// Walls with the painted facade floor by floor, balconies from three floors on, one roof over each polygon: gabled over narrow
/// quadrilaterals of up to two floors, else flat with a parapet. Coordinates are those of the plan minus `origin`.
[[nodiscard]] Model extruded_building(const Region& footprint, double floors, const Vec2& origin);

/// Areas of the ground that do not overlap. Carriageways and water lie a kerb's height below the rest.
struct Ground {
  Region asphalt;
  Region paving;
  Region grass;
  Region water;

  [[nodiscard]] Ground within(const PlanBox& box) const;
};

/// The part of `ground` inside `box`, relative to the box's middle, with kerbs.
[[nodiscard]] Model ground_tile(const Ground& ground, const PlanBox& box);

}  // namespace standin
