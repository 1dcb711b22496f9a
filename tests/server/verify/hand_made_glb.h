// A GLB of a few upright rectangles at known depths before the origin, written by tinygltf: no code of ours is in the loop.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/base/geometry.h"

namespace standin::test {

/// Spans slopes [-half_slope, half_slope] in x and y at z = -depth; texels with `opaque(column, row)` are opaque, row 0 on top.
struct HandMadeQuad {
  double depth_m = 10.0;
  double half_slope = 0.2;
  int texels = 16;  // a side
  std::function<bool(int, int)> opaque = [](int, int) { return true; };
};

struct HandMadeGlb {
  std::string node = "imp_0";
  Vec3 origin{0.0};
  std::string alpha_mode = "MASK";
  std::vector<HandMadeQuad> quads;
};

[[nodiscard]] std::string write_glb(const HandMadeGlb& glb);

}  // namespace standin::test
