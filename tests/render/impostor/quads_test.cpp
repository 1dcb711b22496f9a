// Box growing: every opaque texel in one quad, quads tight, well filled and never larger than a page takes.
#include "render/impostor/quads.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/rng.h"

namespace standin {
namespace {

BitImage blobs(Rng& rng, std::uint32_t width, std::uint32_t height) {
  BitImage mask(width, height);
  for (int blob = 0; blob < 12; ++blob) {
    const double cx = rng.uniform(0, width), cy = rng.uniform(0, height), radius = rng.uniform(1.0, 25.0), inner = rng.uniform(0.0, radius);
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x)
        if (const double r = std::hypot(x - cx, y - cy); r < radius && r >= inner) mask.set(x, y);
  }
  return mask;
}

/// Removes each quad's texels; fails where a quad is not tight about what the quads before left.
void expect_tight_cover(const BitImage& opaque, const std::vector<Quad>& quads, std::uint32_t layer) {
  BitImage left = opaque;
  for (const Quad& q : quads) {
    EXPECT_EQ(q.layer, layer);
    EXPECT_TRUE(left.any(q.x, q.y, q.x + 1, q.y + q.height) && left.any(q.x + q.width - 1, q.y, q.x + q.width, q.y + q.height));
    EXPECT_TRUE(left.any(q.x, q.y, q.x + q.width, q.y + 1) && left.any(q.x, q.y + q.height - 1, q.x + q.width, q.y + q.height));
    for (std::uint32_t y = q.y; y < q.y + q.height; ++y)
      for (std::uint32_t x = q.x; x < q.x + q.width; ++x) left.clear(x, y);
  }
  EXPECT_FALSE(left.any(0, 0, opaque.width(), opaque.height()));
}

std::uint64_t block_texels(const std::vector<Quad>& quads) {
  std::uint64_t sum = 0;
  for (const Quad& q : quads) sum += std::uint64_t{q.width + 2} * (q.height + 2);
  return sum;
}

TEST(Quads, AFullLayerIsOneQuad) {
  BitImage full(100, 37);
  for (std::uint32_t y = 3; y < 31; ++y)
    for (std::uint32_t x = 5; x < 99; ++x) full.set(x, y);
  const auto quads = grow_quads(full, 4, {});
  ASSERT_EQ(quads.size(), 1U);
  EXPECT_EQ(quads[0].x, 5U);
  EXPECT_EQ(quads[0].y, 3U);
  EXPECT_EQ(quads[0].width, 94U);
  EXPECT_EQ(quads[0].height, 28U);
}

TEST(Quads, EmptyLayersHaveNone) {
  EXPECT_TRUE(grow_quads(BitImage(64, 64), 0, {}).empty());
}

TEST(Quads, DistantPartsStayApart) {
  BitImage two(200, 100);
  two.set(3, 3);
  two.set(190, 90);
  const auto quads = grow_quads(two, 0, {});
  ASSERT_EQ(quads.size(), 2U);
  EXPECT_EQ(quads[0].width * quads[0].height, 1U);
}

TEST(Quads, CoverEveryOpaqueTexelTightly) {
  Rng rng(1);
  for (int i = 0; i < 20; ++i) {
    const BitImage opaque = blobs(rng, 150 + static_cast<std::uint32_t>(i), 90);
    for (const std::uint32_t grid : {1U, 4U, 8U, 16U}) {
      SCOPED_TRACE("image " + std::to_string(i) + " grid " + std::to_string(grid));
      expect_tight_cover(opaque, grow_quads(opaque, 2, {.grid_texels = grid}), 2);
    }
  }
}

TEST(Quads, CostLessThanOneTightQuadAndFewerThanCells) {
  Rng rng(2);
  std::uint64_t grown = 0, whole = 0, cells = 0, count = 0;
  for (int i = 0; i < 10; ++i) {
    const BitImage opaque = blobs(rng, 200, 200);
    const auto quads = grow_quads(opaque, 0, {});
    const auto alone = grow_quads(opaque, 0, {.fill_ratio = 1.0, .gutter = 0});
    grown += block_texels(quads);
    whole += block_texels(grow_quads(opaque, 0, {.grid_texels = 200}));
    count += quads.size();
    cells += alone.size();
  }
  EXPECT_LT(grown, 0.8 * static_cast<double>(whole));
  EXPECT_LT(count, cells);
}

TEST(Quads, StayWithinThePage) {
  BitImage full(300, 300);
  for (std::uint32_t y = 0; y < 300; ++y)
    for (std::uint32_t x = 0; x < 300; ++x) full.set(x, y);
  for (const Quad& quad : grow_quads(full, 0, {.max_side = 64})) EXPECT_LE(std::max(quad.width, quad.height), 64U);
}

}  // namespace
}  // namespace standin
