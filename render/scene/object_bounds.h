// The box of several objects.
#pragma once

#include <cstdint>
#include <span>

#include "render/scene/scene.h"

namespace standin {

/// World bounds of the objects with these ids; empty for none. Ids must be in range.
[[nodiscard]] inline Box bounds_of(const Scene& scene, std::span<const std::uint32_t> objects) {
  Box bounds;
  for (const std::uint32_t id : objects) bounds.extend(scene.objects[id].bounds);
  return bounds;
}

}  // namespace standin
