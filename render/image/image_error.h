// How far a picture is from its original: the mean absolute difference, and what an eye would notice (FLIP).
//
// FLIP is made for flipping between two renderings of the same view, which is how impostors are judged: blurred or displaced texels that no
// eye resolves count little, edges that appear or vanish count much. Each picture goes to an opponent colour space (YCxCz), is blurred by
// the eye's contrast sensitivity for each channel at the viewing distance, and compared in Hunt-adjusted L*a*b* (HyAB distance, to the
// power 0.7, mapped to [0, 1]); edges and points that one picture has and the other has not raise that to the power (1 - difference of
// features).
//
// OpenImageIO's compare_Yee cannot serve: it returns how many pixels exceed a threshold of visibility, so a pixel just beyond it and a hole
// count alike, and a placement a little better scores the same.
#pragma once

#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// Mean absolute difference of the colour channels, 0..1. Same size required; alpha is not looked at, here and below.
[[nodiscard]] double mean_error(const Texture& a, const Texture& b);

/// A screen 3840 pixels and 0.7 m wide, seen from 0.7 m: the authors' default.
inline constexpr double kPixelsPerDegree = 67.02064327658226;

/// FLIP for each pixel, 0 (same) to 1, rows from the top. Symmetric. Exactly 0 beyond the reach of the filters (10 pixels) from all pixels
/// that differ. Throws Failure(kInternal) for sizes that differ or `pixels_per_degree` not above 0.
[[nodiscard]] std::vector<float> flip_map(const Texture& a, const Texture& b, double pixels_per_degree = kPixelsPerDegree);
/// Mean over all pixels.
[[nodiscard]] double mean_flip(const Texture& a, const Texture& b, double pixels_per_degree = kPixelsPerDegree);

}  // namespace standin
