#include "server/verify/alpha_sampling.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

struct Tap {
  int texel = 0;
  double weight = 0.0;
};
using Taps = std::array<Tap, 3>;

// The texels of a row of `from` that texel `to` of a row of `count` covers, with their shares.
Taps taps(int to, int count, int from) {
  const double scale = static_cast<double>(from) / count;  // 1, 2, or between 2 and 3
  const double low = to * scale;
  const double high = low + scale;
  Taps result;
  for (int i = 0; i < 3; ++i) {
    const int texel = static_cast<int>(low) + i;
    const double share = std::min(high, texel + 1.0) - std::max(low, static_cast<double>(texel));
    result[static_cast<std::size_t>(i)] = {std::min(texel, from - 1), std::max(0.0, share) / scale};
  }
  return result;
}

}  // namespace

std::string_view sampling_name(AlphaSampling sampling) {
  static constexpr std::array<std::string_view, kAlphaSamplings.size()> kNames = {"nearest", "bilinear", "mipmapped"};
  return kNames.at(static_cast<std::size_t>(sampling));
}

AlphaPage::AlphaPage(const GlbPage& page, bool mipmapped) : page_(page) {
  Level whole{page.width, page.height, {}};
  for (std::size_t i = 3; i < page.rgba.size(); i += 4) whole.alpha.push_back(page.rgba[i]);
  levels_.push_back(std::move(whole));
  while (mipmapped && (levels_.back().width > 1 || levels_.back().height > 1)) levels_.push_back(halved(levels_.back()));
}

AlphaPage::Level AlphaPage::halved(const Level& level) {
  Level half{std::max(1, level.width / 2), std::max(1, level.height / 2), {}};
  half.alpha.reserve(static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  for (int y = 0; y < half.height; ++y) {
    const Taps rows = taps(y, half.height, level.height);
    for (int x = 0; x < half.width; ++x) {
      double sum = 0.0;
      for (const Tap& row : rows)
        for (const Tap& column : taps(x, half.width, level.width))
          sum += row.weight * column.weight *
                 level.alpha[static_cast<std::size_t>(row.texel) * static_cast<std::size_t>(level.width) +
                             static_cast<std::size_t>(column.texel)];
      half.alpha.push_back(static_cast<std::uint8_t>(std::lround(sum)));
    }
  }
  return half;
}

double AlphaPage::bilinear(const Level& level, const Vec2& texel) {
  const Vec2 corner = texel - 0.5;
  const Vec2 base = glm::floor(corner);
  const Vec2 share = corner - base;
  const auto at = [&](double x, double y) {
    const auto column = static_cast<std::size_t>(std::clamp(x, 0.0, level.width - 1.0));
    const auto row = static_cast<std::size_t>(std::clamp(y, 0.0, level.height - 1.0));
    return static_cast<double>(level.alpha[row * static_cast<std::size_t>(level.width) + column]);
  };
  const double above = (1.0 - share.x) * at(base.x, base.y) + share.x * at(base.x + 1.0, base.y);
  const double below = (1.0 - share.x) * at(base.x, base.y + 1.0) + share.x * at(base.x + 1.0, base.y + 1.0);
  return ((1.0 - share.y) * above + share.y * below) / 255.0;
}

double AlphaPage::alpha(const Vec2& texel, double footprint_texels, AlphaSampling sampling) const {
  if (sampling == AlphaSampling::kNearest) {
    const Vec2 held = glm::clamp(glm::floor(texel), Vec2(0.0), Vec2(page_.width - 1.0, page_.height - 1.0));
    return levels_[0].alpha[static_cast<std::size_t>(held.y) * static_cast<std::size_t>(page_.width) + static_cast<std::size_t>(held.x)] /
           255.0;
  }
  const double last = static_cast<double>(levels_.size() - 1);
  const double detail = sampling == AlphaSampling::kBilinear ? 0.0 : std::clamp(std::log2(std::max(footprint_texels, 1.0)), 0.0, last);
  const auto fine = static_cast<std::size_t>(detail);
  const double share = detail - static_cast<double>(fine);
  const auto level_alpha = [&](std::size_t i) {
    const Level& level = levels_[i];
    return bilinear(level, texel * Vec2(level.width, level.height) / Vec2(page_.width, page_.height));
  };
  return share > 0.0 ? (1.0 - share) * level_alpha(fine) + share * level_alpha(fine + 1) : level_alpha(fine);
}

}  // namespace standin
