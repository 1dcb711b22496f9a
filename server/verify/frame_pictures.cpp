#include "server/verify/frame_pictures.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "render/base/parallel.h"
#include "render/image/image_error.h"

namespace standin {
namespace {

constexpr int kAmplification = 4;
constexpr std::size_t kPairsPerThread = 4;

Texture picture(Renderer& renderer, const View& view, const DrawList& list) {
  renderer.draw(view, list);
  return renderer.read_pixels();
}

/// The renderer's background has alpha 0.
Texture opaque(Texture image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

Texture amplified_difference(const Texture& a, const Texture& b) {
  Texture difference = a;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    difference.rgba[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(std::min(255, kAmplification * std::abs(a.rgba[i] - b.rgba[i])));
  return difference;
}

double after_ms(const VerifiedView& view) {
  return view.measured_after_ms.value_or(view.estimated_after_ms);
}

template <class Key>
std::vector<std::uint32_t> descending(const std::vector<VerifiedView>& views, const Key& key) {
  std::vector<std::uint32_t> order(views.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(views[a]) > key(views[b]); });
  return order;
}

}  // namespace

PicturePair draw_pair(Renderer& renderer, const View& view, const FramePair& frames, DrawList FramePair::*shown) {
  return {picture(renderer, view, frames.original), picture(renderer, view, frames.*shown)};
}

PictureError error_of(const PicturePair& pictures) {
  return {mean_error(pictures.original, pictures.with_impostors), mean_flip(pictures.original, pictures.with_impostors)};
}

void compare_pairs(std::size_t count, int threads, const WorkBudget& budget, const std::function<PicturePair(std::size_t)>& draw,
                   const std::function<void(std::size_t, const PicturePair&)>& compare) {
  const std::size_t at_a_time = kPairsPerThread * static_cast<std::size_t>(std::max(1, threads));
  for (std::size_t first = 0; first < count; first += at_a_time) {
    budget.check();
    std::vector<PicturePair> pairs;
    for (std::size_t i = first; i < std::min(count, first + at_a_time); ++i) pairs.push_back(draw(i));
    parallel_for(pairs.size(), threads, budget, [&](std::size_t k) { compare(first + k, pairs[k]); });
  }
}

ViewPictures take_pictures(Renderer& renderer, std::uint32_t index, const View& view, const FramePair& frames) {
  ViewPictures pictures{index, opaque(picture(renderer, view, frames.original)), opaque(picture(renderer, view, frames.after)), {}};
  pictures.difference = amplified_difference(pictures.original, pictures.with_impostors);
  return pictures;
}

Texture ViewPictures::side_by_side() const {
  Texture row{"", 3 * original.width, original.height, {}};
  row.rgba.reserve(3 * original.rgba.size());
  const std::size_t line = 4 * static_cast<std::size_t>(original.width);
  for (std::size_t begin = 0; begin < original.rgba.size(); begin += line)
    for (const Texture* pane : {&original, &with_impostors, &difference})
      row.rgba.insert(row.rgba.end(), &pane->rgba[begin], &pane->rgba[begin] + line);
  return row;
}

std::string picture_file(std::size_t k) {
  return "worst_view_" + std::to_string(k + 1) + ".png";
}

std::vector<std::uint32_t> worst_views(const std::vector<VerifiedView>& views, std::uint32_t count) {
  const auto by_error = descending(views, [](const VerifiedView& view) { return view.mean_error; });
  const auto by_time = descending(views, after_ms);
  std::vector<std::uint32_t> chosen;
  for (std::size_t rank = 0; rank < views.size(); ++rank)
    for (const std::uint32_t view : {by_error[rank], by_time[rank]})
      if (chosen.size() < count && std::find(chosen.begin(), chosen.end(), view) == chosen.end()) chosen.push_back(view);
  return chosen;
}

}  // namespace standin
