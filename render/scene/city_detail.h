// How a parametric model meets a triangle budget: the finest level of detail that fits.
#pragma once

#include <cstdint>

#include "render/scene/city_parts.h"

namespace standin {

/// `build(level)` grows with `level`; the result is build(0) where nothing fits.
template <typename Build>
[[nodiscard]] Model finest_within(std::uint64_t triangles, const Build& build) {
  int fits = 0;
  int exceeds = 1;
  while (build(exceeds).triangle_count() <= triangles) {
    fits = exceeds;
    exceeds *= 2;
  }
  while (exceeds - fits > 1) {
    const int middle = fits + (exceeds - fits) / 2;
    (build(middle).triangle_count() <= triangles ? fits : exceeds) = middle;
  }
  return build(fits);
}

}  // namespace standin
