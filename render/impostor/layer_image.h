// The texels of one layer while it is recorded.
//
// Most layers of a cluster are nearly empty (thesis 3.5), so texels live in tiles that come into being where something is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

namespace standin {

struct RecordedTexel {
  std::array<std::uint8_t, 4> rgba{0, 0, 0, 0};  // alpha 255: opaque, 0: nothing drawn yet
  float order = 0.0F;                            // of two surfaces in one texel the one of lower order wins

  [[nodiscard]] bool opaque() const { return rgba[3] != 0; }
};

class LayerImage {
 public:
  LayerImage(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), tiles_per_row_((width + kTileSide - 1) / kTileSide) {}

  /// Makes the texel's tile where it is missing. x < width, y < height.
  RecordedTexel& at(std::uint32_t x, std::uint32_t y) {
    if (tile_of_.empty()) tile_of_.assign(std::size_t{tiles_per_row_} * ((height_ + kTileSide - 1) / kTileSide), kNoTile);
    std::uint32_t& tile = tile_of_[tile_index(x, y)];
    if (tile == kNoTile) {
      tile = static_cast<std::uint32_t>(tiles_.size());
      tiles_.emplace_back();
    }
    return tiles_[tile][texel_index(x, y)];
  }

  /// The texel as it is, undrawn where nothing was drawn.
  [[nodiscard]] const RecordedTexel& get(std::uint32_t x, std::uint32_t y) const {
    static constexpr RecordedTexel kUndrawn;
    const std::uint32_t tile = tile_of_.empty() ? kNoTile : tile_of_[tile_index(x, y)];
    return tile == kNoTile ? kUndrawn : tiles_[tile][texel_index(x, y)];
  }

  /// visit(x, y) for each opaque texel.
  template <class Visit>
  void for_each_opaque(const Visit& visit) const {
    for (std::size_t i = 0; i < tile_of_.size(); ++i) {
      if (tile_of_[i] == kNoTile) continue;
      const auto x0 = static_cast<std::uint32_t>(i % tiles_per_row_) * kTileSide;
      const auto y0 = static_cast<std::uint32_t>(i / tiles_per_row_) * kTileSide;
      for (std::uint32_t k = 0; k < kTileSide * kTileSide; ++k)
        if (tiles_[tile_of_[i]][k].opaque()) visit(x0 + k % kTileSide, y0 + k / kTileSide);
    }
  }

  [[nodiscard]] bool empty() const { return tiles_.empty(); }
  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }

 private:
  static constexpr std::uint32_t kTileSide = 16;
  static constexpr std::uint32_t kNoTile = 0xFFFFFFFF;
  using Tile = std::array<RecordedTexel, kTileSide * kTileSide>;

  [[nodiscard]] std::size_t tile_index(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{y / kTileSide} * tiles_per_row_ + x / kTileSide;
  }
  [[nodiscard]] static std::size_t texel_index(std::uint32_t x, std::uint32_t y) {
    return std::size_t{y % kTileSide} * kTileSide + x % kTileSide;
  }

  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  std::uint32_t tiles_per_row_ = 0;
  std::vector<std::uint32_t> tile_of_;  // empty until something is drawn
  std::deque<Tile> tiles_;
};

}  // namespace standin
