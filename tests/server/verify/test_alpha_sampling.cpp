// Filtered alpha of pages whose values are known by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "server/verify/alpha_sampling.h"

namespace standin {
namespace {

GlbPage page(int width, int height, const std::function<int(int, int)>& alpha) {
  GlbPage result{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int c : {10, 20, 30, alpha(x, y)}) result.rgba.push_back(static_cast<std::uint8_t>(c));
  return result;
}

TEST(AlphaSampling, NearestTakesTheTexelThatHoldsThePoint) {
  const GlbPage columns = page(4, 1, [](int x, int) { return x == 2 ? 255 : 0; });
  const AlphaPage sampled(columns, false);
  EXPECT_FALSE(sampled.is_opaque({1.999, 0.5}, 0.0, AlphaSampling::kNearest));
  EXPECT_TRUE(sampled.is_opaque({2.0, 0.5}, 0.0, AlphaSampling::kNearest));
  EXPECT_TRUE(sampled.is_opaque({2.999, 0.5}, 0.0, AlphaSampling::kNearest));
  EXPECT_FALSE(sampled.is_opaque({-3.0, 9.0}, 0.0, AlphaSampling::kNearest)) << "clamps to texel 0";
}

// Centres lie at halves: between them alpha is linear, so a line of opaque texels keeps its outline, and a lone one shrinks to a lozenge.
TEST(AlphaSampling, BilinearIsLinearBetweenCentres) {
  const GlbPage half = page(8, 8, [](int x, int) { return x >= 4 ? 255 : 0; });
  const AlphaPage sampled(half, false);
  for (const double share : {0.0, 0.25, 0.5, 0.9})
    EXPECT_NEAR(sampled.alpha({3.5 + share, 4.2}, 0.0, AlphaSampling::kBilinear), share, 1e-12);
  EXPECT_EQ(sampled.alpha({100.0, -5.0}, 0.0, AlphaSampling::kBilinear), 1.0);
  const GlbPage lone = page(8, 8, [](int x, int y) { return x == 4 && y == 4 ? 255 : 0; });
  const AlphaPage dot(lone, false);
  EXPECT_NEAR(dot.alpha({4.75, 4.75}, 0.0, AlphaSampling::kBilinear), 0.75 * 0.75, 1e-12);
  EXPECT_FALSE(dot.is_opaque({4.9, 4.9}, 0.0, AlphaSampling::kBilinear)) << "0.36: the corner is lost";
  EXPECT_TRUE(dot.is_opaque({4.9, 4.9}, 0.0, AlphaSampling::kNearest));
}

// Every other column: one level up all is grey, which 8 bits round to 128.
TEST(AlphaSampling, MipmapsAverageAndBlend) {
  const GlbPage stripes = page(8, 8, [](int x, int) { return x % 2 == 0 ? 255 : 0; });
  const AlphaPage sampled(stripes, true);
  const Vec2 centre(2.5, 3.5);
  EXPECT_EQ(sampled.alpha(centre, 0.3, AlphaSampling::kMipmapped), 1.0) << "magnified";
  EXPECT_EQ(sampled.alpha(centre, 1.0, AlphaSampling::kMipmapped), 1.0);
  EXPECT_NEAR(sampled.alpha(centre, 2.0, AlphaSampling::kMipmapped), 128.0 / 255.0, 1e-12);
  EXPECT_NEAR(sampled.alpha(centre, std::sqrt(2.0), AlphaSampling::kMipmapped), 0.5 * (1.0 + 128.0 / 255.0), 1e-12);
  EXPECT_NEAR(sampled.alpha(centre, 1e9, AlphaSampling::kMipmapped), 128.0 / 255.0, 1e-12);
}

// 3 x 1 halves to one texel that covers all three alike; 5 x 1 to two of which each takes half of the middle one.
TEST(AlphaSampling, OddSizesAreWeightedByArea) {
  const GlbPage three = page(3, 1, [](int x, int) { return x == 1 ? 255 : 0; });
  EXPECT_NEAR(AlphaPage(three, true).alpha({1.5, 0.5}, 1e9, AlphaSampling::kMipmapped), 85.0 / 255.0, 1e-12);
  const GlbPage five = page(5, 1, [](int x, int) { return x == 2 ? 250 : 0; });
  const AlphaPage sampled(five, true);
  EXPECT_NEAR(sampled.alpha({1.25, 0.5}, 2.0, AlphaSampling::kMipmapped), 50.0 / 255.0, 1e-12);
  EXPECT_NEAR(sampled.alpha({3.75, 0.5}, 2.0, AlphaSampling::kMipmapped), 50.0 / 255.0, 1e-12);
}

TEST(AlphaSampling, TheCutoffIsTheMaterials) {
  GlbPage grey = page(2, 2, [](int, int) { return 100; });
  EXPECT_FALSE(AlphaPage(grey, false).is_opaque({1.0, 1.0}, 0.0, AlphaSampling::kBilinear));
  grey.alpha_cutoff = 0.3;
  EXPECT_TRUE(AlphaPage(grey, false).is_opaque({1.0, 1.0}, 0.0, AlphaSampling::kBilinear));
}

}  // namespace
}  // namespace standin
