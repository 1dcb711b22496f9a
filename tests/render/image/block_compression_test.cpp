// Block compression: every mask survives, colours come back as close as the format allows, and a decoder written from the formats'
// definition reads the same texels as the library's.
#include "render/image/block_compression.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/base/rng.h"

namespace standin {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

template <class TexelAt>
Texture texture_of(int width, int height, const TexelAt& texel_at) {
  Texture texture{"", width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Rgba rgba = texel_at(x, y);
      texture.rgba.insert(texture.rgba.end(), rgba.begin(), rgba.end());
    }
  return texture;
}

std::uint8_t random_byte(Rng& rng) {
  return static_cast<std::uint8_t>(rng.below(256));
}

/// Random colours, each texel opaque with the given probability; transparent ones have any colour, as dilated atlases do.
Texture noise(int width, int height, double opaque_share, std::uint64_t seed) {
  Rng rng(seed);
  return texture_of(width, height, [&](int, int) {
    const bool opaque = rng.uniform() < opaque_share;
    return Rgba{random_byte(rng), random_byte(rng), random_byte(rng), static_cast<std::uint8_t>(opaque ? 255 : 0)};
  });
}

// ---- a decoder of our own, after the formats' definition (EXT_texture_compression_s3tc) ----

std::uint64_t little_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return value;
}

std::array<int, 3> from_565(std::uint64_t bits) {
  const int r = static_cast<int>(bits >> 11 & 31), g = static_cast<int>(bits >> 5 & 63), b = static_cast<int>(bits & 31);
  return {r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2};
}

/// Texel `i` of a colour block; `with_alpha`: BC1's rule that endpoints in ascending order make index 3 transparent.
std::array<int, 4> colour_of(const std::uint8_t* block, int i, bool with_alpha) {
  const std::uint64_t first = little_endian(block, 2), second = little_endian(block + 2, 2);
  const auto a = from_565(first), b = from_565(second);
  const int index = static_cast<int>(little_endian(block + 4, 4) >> (2 * i) & 3);
  const bool three = with_alpha && first <= second;
  if (three && index == 3) return {0, 0, 0, 0};
  std::array<int, 4> rgba{0, 0, 0, 255};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::array<int, 4> palette = {a[c], b[c], three ? (a[c] + b[c]) / 2 : (2 * a[c] + b[c]) / 3, (a[c] + 2 * b[c]) / 3};
    rgba[c] = palette[static_cast<std::size_t>(index)];
  }
  return rgba;
}

/// Texel `i` of BC3's alpha block.
int alpha_of(const std::uint8_t* block, int i) {
  const int a = block[0], b = block[1], index = static_cast<int>(little_endian(block + 2, 6) >> (3 * i) & 7);
  if (index == 0) return a;
  if (index == 1) return b;
  if (a > b) return ((8 - index) * a + (index - 1) * b) / 7;
  return index == 6 ? 0 : index == 7 ? 255 : ((6 - index) * a + (index - 1) * b) / 5;
}

std::array<int, 4> texel_of(const BlockTexture& texture, int x, int y) {
  const std::size_t columns = static_cast<std::size_t>(texture.width + 3) / 4, bytes = bytes_per_block(texture.format);
  const std::uint8_t* block = texture.blocks.data() + bytes * (static_cast<std::size_t>(y / 4) * columns + static_cast<std::size_t>(x / 4));
  const int i = 4 * (y % 4) + x % 4;
  if (texture.format == BlockFormat::kBc1) return colour_of(block, i, true);
  std::array<int, 4> rgba = colour_of(block + 8, i, false);
  rgba[3] = alpha_of(block, i);
  return rgba;
}

CompressionLoss loss_of(const Texture& texture, BlockFormat format) {
  CompressionLoss loss;
  loss.add(texture, decompress(compress(texture, format)));
  return loss;
}

constexpr std::array kFormats = {BlockFormat::kBc1, BlockFormat::kBc3};

// All 65,536 masks of a block, in one texture.
TEST(BlockCompression, EveryMaskOfABlockSurvives) {
  Rng rng(3);
  const Texture texture = texture_of(1024, 1024, [&](int x, int y) {
    const int mask = (y / 4) * 256 + x / 4, i = 4 * (y % 4) + x % 4;
    return Rgba{random_byte(rng), random_byte(rng), random_byte(rng), static_cast<std::uint8_t>((mask >> i & 1) != 0 ? 255 : 0)};
  });
  for (const BlockFormat format : kFormats) {
    const CompressionLoss loss = loss_of(texture, format);
    EXPECT_EQ(loss.alpha_changes, 0U);
    EXPECT_EQ(loss.opaque_texels, 8U * 65536U);
  }
}

TEST(BlockCompression, ADecoderOfOurOwnReadsTheSameTexels) {
  for (const BlockFormat format : kFormats)
    for (const double opaque_share : {0.0, 0.3, 0.9, 1.0}) {
      const Texture original = noise(31, 18, opaque_share, 5);
      const BlockTexture compressed = compress(original, format);
      ASSERT_EQ(compressed.blocks.size(), bytes_per_block(format) * 8U * 5U);
      const Texture decoded = decompress(compressed);
      for (int y = 0; y < original.height; ++y)
        for (int x = 0; x < original.width; ++x) {
          const auto expected = texel_of(compressed, x, y);
          const std::uint8_t* rgba = decoded.rgba.data() + 4 * (31 * y + x);
          EXPECT_EQ(rgba[3], expected[3]);
          EXPECT_EQ(original.rgba[static_cast<std::size_t>(4 * (31 * y + x) + 3)] >= 128, expected[3] >= 128);
          if (expected[3] == 0) continue;
          for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(rgba[c], expected[c], 1) << x << " " << y;
        }
    }
}

// Two colours that 5:6:5 bits hold exactly come back as they were, whatever colours lie hidden under transparent texels.
TEST(BlockCompression, ColoursThatTheFormatHoldsAreExact) {
  Rng rng(9);
  const Rgba red{255, 0, 0, 255}, cyan{0, 255, 255, 255};
  const Texture texture = texture_of(64, 64, [&](int x, int y) {
    if ((x + y) % 5 == 0) return Rgba{random_byte(rng), random_byte(rng), random_byte(rng), 0};
    return x % 3 == 0 ? red : cyan;
  });
  for (const BlockFormat format : kFormats) {
    const CompressionLoss loss = loss_of(texture, format);
    EXPECT_TRUE(loss.alpha_exact());
    EXPECT_EQ(loss.psnr_db(), std::nullopt);
    EXPECT_EQ(loss.mean_error(), 0.0);
  }
}

TEST(BlockCompression, SmoothColoursLoseLittleAndNoiseMuch) {
  const Texture smooth = texture_of(64, 64, [](int x, int y) {
    return Rgba{static_cast<std::uint8_t>(2 * x + 40), static_cast<std::uint8_t>(2 * x + 60), static_cast<std::uint8_t>(90 + y), 255};
  });
  for (const BlockFormat format : kFormats) {
    EXPECT_GT(loss_of(smooth, format).psnr_db().value(), 36.0);
    EXPECT_LT(loss_of(noise(64, 64, 1.0, 1), format).psnr_db().value(), 20.0);
  }
}

TEST(BlockCompression, BordersThatFillNoBlockAreCompressedToo) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 7}, {4, 4}, {5, 9}, {1, 64}}) {
    const Texture texture = noise(width, height, 0.5, 2);
    EXPECT_EQ(block_count(texture), static_cast<std::uint64_t>((width + 3) / 4 * ((height + 3) / 4)));
    for (const BlockFormat format : kFormats) {
      const CompressionLoss loss = loss_of(texture, format);
      EXPECT_EQ(loss.texels, static_cast<std::uint64_t>(width * height));
      EXPECT_TRUE(loss.alpha_exact());
    }
  }
}

TEST(BlockCompression, ThreadsDoNotChangeTheBytes) {
  const Texture texture = noise(257, 190, 0.7, 8);
  for (const BlockFormat format : kFormats) EXPECT_EQ(compress(texture, format, 1).blocks, compress(texture, format, 3).blocks);
}

TEST(CompressionLoss, CountsWhatDiffers) {
  const Texture original = texture_of(2, 2, [](int x, int) { return Rgba{100, 100, 100, static_cast<std::uint8_t>(x == 0 ? 255 : 0)}; });
  Texture changed = original;
  changed.rgba[0] = 130;      // an opaque texel's red
  changed.rgba[4] = 7;        // a transparent texel's red: unseen
  changed.rgba[7] = 255;      // transparent made opaque
  changed.rgba[8 + 3] = 127;  // opaque made transparent
  CompressionLoss loss;
  loss.add(original, changed);
  EXPECT_EQ(loss.texels, 4U);
  EXPECT_EQ(loss.opaque_texels, 2U);
  EXPECT_EQ(loss.alpha_changes, 2U);
  EXPECT_DOUBLE_EQ(loss.mean_error(), 30.0 / (255.0 * 6.0));
  EXPECT_DOUBLE_EQ(loss.psnr_db().value(), 10.0 * std::log10(255.0 * 255.0 * 6.0 / 900.0));
}

}  // namespace
}  // namespace standin
