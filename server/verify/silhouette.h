// How far an impostor's silhouette exceeds the original's.
//
// Texels are opaque where the original touches them (closed coverage), so impostors are a little fatter than what they stand for. Bloat is
// the mean distance of the two outlines: pixels covered by the impostor and not by the original, over the length of the original's
// silhouette, both in pixels. Holes of the original (between leaves) have outlines too, and count where the impostor fills them.
#pragma once

#include <cstdint>
#include <vector>

namespace standin {

/// Whether a pixel is covered; rows from the top.
struct CoverageImage {
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::vector<bool> covered{};

  CoverageImage(int width_px, int height_px)
      : width(width_px), height(height_px), covered(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), false) {}
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool at(int x, int y) const { return covered[index(x, y)]; }
  void set(int x, int y, bool value) { covered[index(x, y)] = value; }
};

/// Length of the outlines in pixels: of the contours that marching squares draws between pixel centres. Exact for outlines along rows,
/// columns and diagonals (but a corner is cut by 1 - sqrt(1/2) pixels), up to 8 % long in between. The image's border is no outline.
[[nodiscard]] double silhouette_length_px(const CoverageImage& image);

/// Pixels that `impostor` covers and `original`, of the same size, does not.
[[nodiscard]] std::uint64_t excess_pixels(const CoverageImage& original, const CoverageImage& impostor);

}  // namespace standin
