// Pictures of frames with and without impostors, and what they differ in.
#pragma once

#include <functional>
#include <vector>

#include "render/device/renderer.h"
#include "server/verify/verify.h"

namespace standin {

/// What a view draws without and with what was placed.
struct FramePair {
  DrawList original;  // the visible originals
  DrawList before;    // the same at their levels of detail: without impostors
  DrawList after;     // what the placement says
};

/// Of two pictures, over all their pixels, 0..1 (image_error.h).
struct PictureError {
  double mean_error = 0.0;
  double mean_flip = 0.0;
};

/// As drawn: the background has alpha 0.
struct PicturePair {
  Texture original;
  Texture with_impostors;
};
/// Originals beside one of the other two.
[[nodiscard]] PicturePair draw_pair(Renderer& renderer, const View& view, const FramePair& frames, DrawList FramePair::*shown);
[[nodiscard]] PictureError error_of(const PicturePair& pictures);

/// draw(i) for each i in 0..count-1, in order in the calling thread, which the device's context belongs to; compare(i, pair), which takes
/// longer, on several threads, a few pairs at a time. compare writes only to slots of its own index.
void compare_pairs(std::size_t count, int threads, const WorkBudget& budget, const std::function<PicturePair(std::size_t)>& draw,
                   const std::function<void(std::size_t, const PicturePair&)>& compare);

/// Both pictures, opaque, and their difference amplified.
[[nodiscard]] ViewPictures take_pictures(Renderer& renderer, std::uint32_t index, const View& view, const FramePair& frames);

/// The views worth looking at, at most `count`: by turns the largest image error and the slowest frame with impostors.
[[nodiscard]] std::vector<std::uint32_t> worst_views(const std::vector<VerifiedView>& views, std::uint32_t count);

}  // namespace standin
