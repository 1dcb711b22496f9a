// From a layer's opaque texels to few, well-filled rectangles (thesis 3.5).
//
// Box growing on a coarse grid: a filled cell is the seed, and the box takes in the neighbouring row, column or corner that is filled best,
// while enough of the whole box is filled. Boxes shrink to the opaque texels they hold. Since every block carries a gutter in the atlas,
// boxes that together cost no more than apart are joined again.
#pragma once

#include <vector>

#include "render/impostor/bit_image.h"
#include "render/impostor/impostor.h"

namespace standin {

struct BoxGrowing {
  std::uint32_t grid_texels = 8;  // side of a grid cell, >= 1
  double fill_ratio = 0.8;        // of filled cells in a box
  std::uint32_t max_side = 2048;  // texels
  std::uint32_t gutter = 1;       // texels on each side, counted when boxes are joined
};

/// Every opaque texel lies in exactly one quad (the first that holds it, if they overlap). Quads come in rows from the top.
[[nodiscard]] std::vector<Quad> grow_quads(const BitImage& opaque, std::uint32_t layer, const BoxGrowing& settings);

}  // namespace standin
