#include "server/report/pictures.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "render/image/image_io.h"

namespace standin {
namespace {

constexpr int kLargestSide = 1024;

// Box filter by a whole factor, colour weighted by alpha.
Texture shrunk(const Texture& page) {
  const int factor = (std::max(page.width, page.height) + kLargestSide - 1) / kLargestSide;
  if (factor <= 1) return page;
  Texture small{page.name, page.width / factor, page.height / factor, {}};
  small.rgba.reserve(static_cast<std::size_t>(small.width) * small.height * 4);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      for (int dy = 0; dy < factor; ++dy) {
        for (int dx = 0; dx < factor; ++dx) {
          const std::uint8_t* texel = &page.rgba[4 * (static_cast<std::size_t>(y * factor + dy) * page.width + (x * factor + dx))];
          for (int c = 0; c < 3; ++c) sum[c] += static_cast<std::uint32_t>(texel[c]) * texel[3];
          sum[3] += texel[3];
        }
      }
      for (int c = 0; c < 3; ++c) small.rgba.push_back(static_cast<std::uint8_t>(sum[3] > 0 ? sum[c] / sum[3] : 0));
      small.rgba.push_back(static_cast<std::uint8_t>(sum[3] / static_cast<std::uint32_t>(factor * factor)));
    }
  }
  return small;
}

std::string caption_of(const VerifiedView& view) {
  char text[160];
  std::snprintf(text, sizeof text, "estimated %.1f ms before, %.1f ms after; mean image error %.4f, FLIP %.4f", view.estimated_before_ms,
                view.estimated_after_ms, view.mean_error, view.mean_flip);
  return text;
}

}  // namespace

std::vector<ReportPicture> report_pictures(const VerifyResult& verified, const ImpostorSet& set) {
  std::vector<ReportPicture> pictures;
  for (std::size_t k = 0; k < verified.pictures.size(); ++k) {
    const ViewPictures& view = verified.pictures[k];
    const std::string name = "view-" + std::to_string(k);
    const std::string caption = caption_of(verified.views[view.view]);
    pictures.push_back({name + "/original", caption, encode_png(view.original)});
    pictures.push_back({name + "/with_impostors", caption, encode_png(view.with_impostors)});
    pictures.push_back({name + "/difference", caption, encode_png(view.difference)});
  }
  for (std::size_t page = 0; page < set.pages.size(); ++page)
    pictures.push_back({"atlas-" + std::to_string(page), "atlas page " + std::to_string(page), encode_png(shrunk(set.pages[page]))});
  return pictures;
}

}  // namespace standin
