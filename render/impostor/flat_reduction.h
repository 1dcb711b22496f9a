// Removes the vertices of a complex that its surface does not need: the first step of simplification, without loss.
#pragma once

#include "render/impostor/triangle_complex.h"

namespace standin {

/// Integer normal, in half texels and half layers.
struct LatticeNormal {
  std::int64_t x = 0, y = 0, z = 0;
  friend bool operator==(const LatticeNormal&, const LatticeNormal&) = default;
};
[[nodiscard]] LatticeNormal lattice_normal(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c);
[[nodiscard]] inline std::int64_t dot(const LatticeNormal& a, const LatticeNormal& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Takes vertices into neighbours as long as that changes no point of the surface and of its borders. Vertices half way down a step of a
/// slope are kept for what follows.
void reduce_flat_parts(TriangleComplex& complex);

}  // namespace standin
