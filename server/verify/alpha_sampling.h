// Where an impostor's page is opaque, under each of the ways in which viewers sample textures.
//
// The promise (architecture.md, gap pixel) is made for the nearest texel. Viewers filter all the same, so what holds then must be measured:
// bilinear interpolates the stored alpha between the centres of four texels; mipmapped does so on the two levels of a box-filtered chain
// around the footprint's size (OpenGL 4.5, 8.14.1) and between them. Either way the result is cut at the material's cutoff, after
// filtering. Coordinates clamp at the page's edges. Levels halve, rounding down; a texel of a level is the mean of the area that it covers
// below, which for odd sizes takes shares of three texels; 8 bits each, as a device keeps them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "server/verify/glb_quads.h"

namespace standin {

enum class AlphaSampling : std::uint8_t { kNearest, kBilinear, kMipmapped };
inline constexpr std::array kAlphaSamplings = {AlphaSampling::kNearest, AlphaSampling::kBilinear, AlphaSampling::kMipmapped};
/// "nearest", "bilinear", "mipmapped".
[[nodiscard]] std::string_view sampling_name(AlphaSampling sampling);

class AlphaPage {
 public:
  /// `page` must outlive this. The chain is made for kMipmapped only: without `mipmapped` that is not to be asked for.
  AlphaPage(const GlbPage& page, bool mipmapped);

  /// Filtered alpha in 0..1. `texel`: coordinates in texels of the page; `footprint_texels`: by how many texels the coordinates change from
  /// pixel to pixel, the greater of the two directions (only kMipmapped looks at it).
  [[nodiscard]] double alpha(const Vec2& texel, double footprint_texels, AlphaSampling sampling) const;
  [[nodiscard]] bool is_opaque(const Vec2& texel, double footprint_texels, AlphaSampling sampling) const {
    return alpha(texel, footprint_texels, sampling) >= page_.alpha_cutoff;
  }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> alpha;
  };
  [[nodiscard]] static Level halved(const Level& level);
  [[nodiscard]] static double bilinear(const Level& level, const Vec2& texel);

  const GlbPage& page_;
  std::vector<Level> levels_;  // the page itself first
};

}  // namespace standin
