// Pictures of frames with and without impostors, and what they differ in.
#pragma once

#include <vector>

#include "render/device/renderer.h"
#include "server/verify/verify.h"

namespace standin {

/// What a view draws before and after placement.
struct FramePair {
  DrawList before;  // the visible originals
  DrawList after;   // what the placement says
};

/// Of the two pictures, over all their pixels, 0..1 (image_error.h).
struct PictureError {
  double mean_error = 0.0;
  double mean_flip = 0.0;
};
/// 0 without drawing where no impostor is in the frame.
[[nodiscard]] PictureError picture_error(Renderer& renderer, const View& view, const FramePair& frames);
/// Both pictures, opaque, and their difference amplified.
[[nodiscard]] ViewPictures take_pictures(Renderer& renderer, std::uint32_t index, const View& view, const FramePair& frames);

/// The views worth looking at, at most `count`: by turns the largest image error and the slowest frame with impostors.
[[nodiscard]] std::vector<std::uint32_t> worst_views(const std::vector<VerifiedView>& views, std::uint32_t count);

}  // namespace standin
