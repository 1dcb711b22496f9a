// Outlines whose length and distance are known by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "server/verify/silhouette.h"

namespace standin {
namespace {

CoverageImage drawn(int size, const std::function<bool(int, int)>& covered) {
  CoverageImage image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) image.set(x, y, covered(x, y));
  return image;
}

CoverageImage square(int size, int margin) {
  return drawn(size, [&](int x, int y) { return std::min({x, y, size - 1 - x, size - 1 - y}) >= margin; });
}

// Four sides of 29 pixels between centres, four cut corners.
TEST(Silhouette, OfASquareIsItsSidesAndItsCutCorners) {
  EXPECT_NEAR(silhouette_length_px(square(40, 5)), 4.0 * 29.0 + 4.0 / std::numbers::sqrt2, 1e-12);
}

TEST(Silhouette, OfALozengeIsExact) {
  const CoverageImage lozenge = drawn(41, [](int x, int y) { return std::abs(x - 20) + std::abs(y - 20) <= 10; });
  EXPECT_NEAR(silhouette_length_px(lozenge), 4.0 * 10.0 * std::numbers::sqrt2 + 4.0 / std::numbers::sqrt2, 1e-9);
}

TEST(Silhouette, OfADiscIsNotMuchTooLong) {
  const CoverageImage disc = drawn(300, [](int x, int y) { return std::hypot(x - 150, y - 150) <= 120.0; });
  const double length = silhouette_length_px(disc) / (2.0 * std::numbers::pi * 120.0);
  EXPECT_GT(length, 1.0);
  EXPECT_LT(length, 1.08);
}

TEST(Silhouette, HolesHaveOutlinesAndBordersHaveNone) {
  const CoverageImage holed = drawn(40, [](int x, int y) { return x < 10 || x >= 20 || y < 10 || y >= 20; });
  EXPECT_NEAR(silhouette_length_px(holed), 4.0 * 9.0 + 4.0 / std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(silhouette_length_px(square(40, 0)), 0.0);
  EXPECT_EQ(silhouette_length_px(drawn(40, [](int x, int) { return x < 7; })), 39.0);
}

TEST(Silhouette, ExcessIsWhatOnlyTheImpostorCovers) {
  EXPECT_EQ(excess_pixels(square(40, 5), square(40, 4)), 32U * 32U - 30U * 30U);
  EXPECT_EQ(excess_pixels(square(40, 4), square(40, 5)), 0U);
  EXPECT_EQ(excess_pixels(square(40, 5), square(40, 5)), 0U);
}

}  // namespace
}  // namespace standin
