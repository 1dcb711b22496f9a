// Occlusion culling among an impostor's own layers (thesis 3.4, math.md 3).
//
// Layers lie one texel of parallax apart, so a ray that meets texel (i, j) passes the layer before it within one texel of (i, j). Umbra: a
// texel behind a full 3 x 3 block of opaque or hidden texels is hidden. Corner: along one ray the shift keeps its sign on each axis through
// all layers, so a ray of one sign class meets one of 2 x 2 texels only; a texel that is hidden for all four classes is hidden. That finds
// everything the umbra does, and what overlapping penumbrae hide. Conservative while every gap keeps the one-texel spacing, outside the
// texture counts as transparent, and masks are the complete (supercover) ones.
#pragma once

#include <vector>

#include "render/impostor/bit_image.h"

namespace standin {

enum class CullRule { kUmbra, kCorner };

class OcclusionCulling {
 public:
  OcclusionCulling(std::uint32_t width, std::uint32_t height, CullRule rule);

  /// Which texels of the next layer (near to far) nobody in the view cell can see.
  [[nodiscard]] BitImage hidden_in_next(const BitImage& opaque);
  /// Which places of the next layer nobody can see, opaque or not.
  [[nodiscard]] BitImage hidden() const;

 private:
  CullRule rule_;
  std::vector<BitImage> hidden_;  // of the next layer, opaque or not, one for each sign class
};

}  // namespace standin
