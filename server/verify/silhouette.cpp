#include "server/verify/silhouette.h"

#include <array>
#include <numbers>

namespace standin {
namespace {

// By the four centres of a square that are covered (bits: upper left, upper right, lower left, lower right): one corner alone is cut off
// along a diagonal, two side by side are parted by a straight line, two opposite ones are two corners.
constexpr double kCut = 1.0 / std::numbers::sqrt2;
constexpr std::array<double, 16> kLength = {0.0,  kCut,       kCut, 1.0,  kCut, 1.0,  2.0 * kCut, kCut,
                                            kCut, 2.0 * kCut, 1.0,  kCut, 1.0,  kCut, kCut,       0.0};

}  // namespace

double silhouette_length_px(const CoverageImage& image) {
  double length = 0.0;
  for (int y = 0; y + 1 < image.height; ++y)
    for (int x = 0; x + 1 < image.width; ++x) {
      const int square =
          (image.at(x, y) ? 1 : 0) | (image.at(x + 1, y) ? 2 : 0) | (image.at(x, y + 1) ? 4 : 0) | (image.at(x + 1, y + 1) ? 8 : 0);
      length += kLength[static_cast<std::size_t>(square)];
    }
  return length;
}

std::uint64_t excess_pixels(const CoverageImage& original, const CoverageImage& impostor) {
  std::uint64_t excess = 0;
  for (std::size_t i = 0; i < original.covered.size(); ++i) excess += impostor.covered[i] && !original.covered[i] ? 1 : 0;
  return excess;
}

}  // namespace standin
