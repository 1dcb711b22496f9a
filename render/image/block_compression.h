// What a texture takes in the formats that GPUs hold textures in, and what these formats cost in colour.
//
// The thesis counts impostor memory in uncompressed texels (3.7.2), and so does our objective; but an engine keeps atlas pages in blocks of
// 4 x 4 texels of fixed size. BC1 has 8 bytes a block and one bit of alpha, BC3 16 bytes and eight bits of alpha. Impostors are masked:
// a texel that changes from opaque to transparent is a hole, one that changes back a fin. So alpha must survive compression exactly, and
// whether it did is measured after decoding, as is the error of the colours that are seen.
//
// One level of detail: impostors are drawn with nearest-texel sampling. Through libsquish, which nothing else includes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"

namespace standin {

enum class BlockFormat : std::uint8_t { kBc1, kBc3 };

/// Texels of a side of a block, in every format here.
inline constexpr int kBlockTexels = 4;
[[nodiscard]] std::uint64_t block_count(const Texture& texture);
[[nodiscard]] std::uint32_t bytes_per_block(BlockFormat format);

/// Blocks in rows from the top; those at the right and lower border are filled up with texels that nobody reads.
struct BlockTexture {
  BlockFormat format = BlockFormat::kBc1;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> blocks;
};

/// The same bytes for any number of threads. BC1 keeps a texel opaque from alpha 128 on.
[[nodiscard]] BlockTexture compress(const Texture& texture, BlockFormat format, int threads = 1, const WorkBudget& budget = {});
/// As a GPU reads it.
[[nodiscard]] Texture decompress(const BlockTexture& texture);

/// What compression changed, summed over textures.
struct CompressionLoss {
  std::uint64_t texels = 0;
  std::uint64_t opaque_texels = 0;
  std::uint64_t alpha_changes = 0;  // texels that became opaque, or ceased to be
  double absolute_error = 0.0;      // sums over the opaque texels and their three channels, in units of 1/255
  double squared_error = 0.0;

  /// Adds the difference between a texture and its decoded form of the same size.
  void add(const Texture& original, const Texture& decoded);
  [[nodiscard]] bool alpha_exact() const { return alpha_changes == 0; }
  /// Mean absolute error of opaque texels, 0..1.
  [[nodiscard]] double mean_error() const;
  /// Peak signal-to-noise ratio of opaque texels; nothing where no colour differs.
  [[nodiscard]] std::optional<double> psnr_db() const;
};

}  // namespace standin
