// Blocks are compressed one by one: the library's own loop over an image takes all processors, whatever the job's threads.
#include "render/image/block_compression.h"

#include <squish.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "render/base/parallel.h"

namespace standin {
namespace {

constexpr std::uint8_t kOpaqueFrom = 128;  // the mask's cutoff is 0.5
constexpr std::size_t kBlockArea = std::size_t{kBlockTexels} * kBlockTexels;

int blocks_across(int texels) {
  return (texels + kBlockTexels - 1) / kBlockTexels;
}

/// Colours of transparent texels are never seen. BC1 has none for them; in BC3 they weigh next to nothing.
int squish_flags(BlockFormat format) {
  return format == BlockFormat::kBc1 ? squish::kDxt1 | squish::kColourClusterFit
                                     : squish::kDxt5 | squish::kColourClusterFit | squish::kWeightColourByAlpha;
}

/// A block's texels, and a bit for each that lies within the texture.
struct BlockOfTexels {
  std::array<std::uint8_t, 4 * kBlockArea> rgba{};
  int inside = 0;
};

std::size_t byte_of(int width, int x, int y) {
  return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
}

BlockOfTexels block_at(const Texture& texture, int left, int top) {
  BlockOfTexels block;
  for (int i = 0; i < static_cast<int>(kBlockArea); ++i) {
    const int x = left + i % kBlockTexels, y = top + i / kBlockTexels;
    if (x >= texture.width || y >= texture.height) continue;
    block.inside |= 1 << i;
    std::copy_n(texture.rgba.begin() + static_cast<std::ptrdiff_t>(byte_of(texture.width, x, y)), 4, block.rgba.begin() + 4 * i);
  }
  return block;
}

/// Gives transparent texels a colour that is in the block anyway: even the little that they weigh would be felt.
void hide_transparent_colours(BlockOfTexels& block) {
  const std::uint8_t* seen = nullptr;
  for (std::size_t i = 0; i < block.rgba.size() && seen == nullptr; i += 4)
    if (block.rgba[i + 3] >= kOpaqueFrom) seen = &block.rgba[i];
  if (seen == nullptr) return;
  for (std::size_t i = 0; i < block.rgba.size(); i += 4)
    if (block.rgba[i + 3] < kOpaqueFrom) std::copy_n(seen, 3, block.rgba.begin() + static_cast<std::ptrdiff_t>(i));
}

}  // namespace

std::uint64_t block_count(const Texture& texture) {
  return static_cast<std::uint64_t>(blocks_across(texture.width)) * static_cast<std::uint64_t>(blocks_across(texture.height));
}

std::uint32_t bytes_per_block(BlockFormat format) {
  return format == BlockFormat::kBc1 ? 8 : 16;
}

BlockTexture compress(const Texture& texture, BlockFormat format, int threads, const WorkBudget& budget) {
  BlockTexture compressed{format, texture.width, texture.height, {}};
  const std::size_t bytes = bytes_per_block(format);
  compressed.blocks.resize(bytes * block_count(texture));
  const int columns = blocks_across(texture.width);
  parallel_for(static_cast<std::size_t>(blocks_across(texture.height)), threads, budget, [&](std::size_t row) {
    budget.check();
    std::uint8_t* out = compressed.blocks.data() + row * bytes * static_cast<std::size_t>(columns);
    for (int column = 0; column < columns; ++column, out += bytes) {
      BlockOfTexels block = block_at(texture, column * kBlockTexels, static_cast<int>(row) * kBlockTexels);
      hide_transparent_colours(block);
      squish::CompressMasked(block.rgba.data(), block.inside, out, squish_flags(format));
    }
  });
  return compressed;
}

Texture decompress(const BlockTexture& compressed) {
  Texture texture{"", compressed.width, compressed.height, {}};
  texture.rgba.resize(byte_of(compressed.width, 0, compressed.height));
  const std::uint8_t* in = compressed.blocks.data();
  for (int top = 0; top < compressed.height; top += kBlockTexels)
    for (int left = 0; left < compressed.width; left += kBlockTexels, in += bytes_per_block(compressed.format)) {
      std::array<std::uint8_t, 4 * kBlockArea> rgba{};
      squish::Decompress(rgba.data(), in, squish_flags(compressed.format));
      const auto columns = static_cast<std::size_t>(std::min(kBlockTexels, compressed.width - left));
      for (int y = top; y < std::min(top + kBlockTexels, compressed.height); ++y)
        std::copy_n(rgba.begin() + 4 * kBlockTexels * (y - top), 4 * columns,
                    texture.rgba.begin() + static_cast<std::ptrdiff_t>(byte_of(compressed.width, left, y)));
    }
  return texture;
}

void CompressionLoss::add(const Texture& original, const Texture& decoded) {
  for (std::size_t i = 0; i + 3 < original.rgba.size(); i += 4) {
    const bool was_opaque = original.rgba[i + 3] >= kOpaqueFrom, is_opaque = decoded.rgba[i + 3] >= kOpaqueFrom;
    ++texels;
    alpha_changes += was_opaque != is_opaque ? 1 : 0;
    if (!was_opaque) continue;
    ++opaque_texels;
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = std::abs(int{original.rgba[i + c]} - int{decoded.rgba[i + c]});
      absolute_error += error;
      squared_error += error * error;
    }
  }
}

double CompressionLoss::mean_error() const {
  return opaque_texels > 0 ? absolute_error / (3.0 * 255.0 * static_cast<double>(opaque_texels)) : 0.0;
}

std::optional<double> CompressionLoss::psnr_db() const {
  if (squared_error == 0.0) return std::nullopt;
  return 10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(opaque_texels) / squared_error);
}

}  // namespace standin
