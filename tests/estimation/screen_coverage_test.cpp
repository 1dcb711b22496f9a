#include "estimation/screen_coverage.h"

#include <gtest/gtest.h>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr auto kPlain = static_cast<std::size_t>(PixelKind::kPlain);
constexpr auto kTextured = static_cast<std::size_t>(PixelKind::kTextured);
constexpr auto kMasked = static_cast<std::size_t>(PixelKind::kMasked);
constexpr double kCellPixels = 32.0 * 32.0;  // 512 / 16

const Camera kCamera;

TEST(ScreenCoverage, LetsAllPassWhereThereIsRoom) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 16.0, 16.0, 10.0, 500.0);
  coverage.add(PixelKind::kTextured, 16.0, 16.0, 10.0, 300.0);
  coverage.add(PixelKind::kMasked, 16.0, 16.0, 5.0, 200.0);
  EXPECT_EQ(coverage.passed(), (std::array{500.0, 300.0, 200.0}));
}

// Twice what fits, one part plain and three textured: both give way alike.
TEST(ScreenCoverage, ShareAFullCell) {
  ScreenCoverage coverage(kCamera);
  const double full = kOverdraw * kCellPixels;
  for (int i = 0; i < 8; ++i) coverage.add(i < 2 ? PixelKind::kPlain : PixelKind::kTextured, 16.0, 16.0, 10.0, 0.25 * full);
  EXPECT_NEAR(coverage.passed()[kPlain], 0.25 * full, 1e-9);
  EXPECT_NEAR(coverage.passed()[kTextured], 0.75 * full, 1e-9);
}

// A tree before a house that fills the cell: all of the tree shows; behind the house, nothing of it; beside it (the same octave of
// distance) half.
TEST(ScreenCoverage, MaskedPixelsPassBeforeOpaqueOnes) {
  const auto masked = [](double depth_m) {
    ScreenCoverage coverage(kCamera);
    for (int half = 0; half < 2; ++half) coverage.add(PixelKind::kTextured, 16.0, 16.0, 20.0, 0.5 * kCellPixels);
    coverage.add(PixelKind::kMasked, 16.0, 16.0, depth_m, 600.0);
    return coverage.passed()[kMasked];
  };
  EXPECT_EQ(masked(10.0), 600.0);
  EXPECT_NEAR(masked(20.0), 300.0, 1e-9);
  EXPECT_EQ(masked(40.0), 0.0);
}

TEST(ScreenCoverage, MaskedPixelsFillACellToo) {
  ScreenCoverage coverage(kCamera);
  for (int i = 0; i < 9; ++i) coverage.add(PixelKind::kMasked, 16.0, 16.0, 10.0, 1000.0);
  EXPECT_NEAR(coverage.passed()[kMasked], kOverdraw * kCellPixels, 1e-9);
}

// Leaves before walls: the leaves pass, and the walls share what is left of one and a half images.
TEST(ScreenCoverage, OpaquePixelsShareTheRoomThatMaskedOnesLeave) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kMasked, 16.0, 16.0, 5.0, 900.0);
  for (int half_wall = 0; half_wall < 4; ++half_wall) coverage.add(PixelKind::kPlain, 16.0, 16.0, 20.0, 0.5 * kCellPixels);
  EXPECT_NEAR(coverage.passed()[kMasked], 900.0, 1e-9);
  EXPECT_NEAR(coverage.passed()[kPlain], kOverdraw * kCellPixels - 900.0, 1e-9);
}

TEST(ScreenCoverage, CellsDoNotHideEachOther) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 16.0, 16.0, 10.0, 1000.0);
  coverage.add(PixelKind::kPlain, 48.0, 16.0, 10.0, 1000.0);
  coverage.add(PixelKind::kPlain, 500.0, 500.0, 10.0, 1000.0);
  EXPECT_NEAR(coverage.passed()[kPlain], 3000.0, 1e-9);
}

// A square of 64 x 64 pixels in the middle of four cells lies in all of them.
TEST(ScreenCoverage, ALargeSquareSpreadsOverItsCells) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 32.0, 32.0, 10.0, 4000.0);
  EXPECT_NEAR(coverage.passed()[kPlain], 4000.0, 1e-9);
  // 1,000 pixels in each cell: what lies behind keeps the rest of it.
  for (const auto& [x, y] : {std::pair{16.0, 16.0}, {48.0, 16.0}, {16.0, 48.0}, {48.0, 48.0}})
    coverage.add(PixelKind::kMasked, x, y, 50.0, 500.0);
  EXPECT_NEAR(coverage.passed()[kMasked], 4.0 * 500.0 * (1.0 - 1000.0 / kCellPixels), 1e-9);
}

TEST(ScreenCoverage, NeverPassesMoreThanIsGeneratedNorThanFits) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Rng rng(seed);
    Camera camera;
    camera.width = static_cast<int>(1 + rng.below(2000));
    camera.height = static_cast<int>(1 + rng.below(2000));
    ScreenCoverage coverage(camera);
    std::array<double, kPixelKindCount> generated{};
    for (int i = 0; i < 50; ++i) {
      const auto kind = rng.below(kPixelKindCount);
      const double pixels = std::pow(10.0, rng.uniform(-3.0, 7.0));
      coverage.add(static_cast<PixelKind>(kind), rng.uniform(-10.0, 2010.0), rng.uniform(-10.0, 2010.0),
                   std::pow(10.0, rng.uniform(-2.0, 5.0)), pixels);
      generated[kind] += pixels;
    }
    const auto passed = coverage.passed();
    for (std::size_t kind = 0; kind < kPixelKindCount; ++kind) ASSERT_LE(passed[kind], generated[kind] * (1.0 + 1e-12)) << "seed " << seed;
    const double room = kOverdraw * camera.width * camera.height * (1.0 + 1e-12);
    ASSERT_LE(passed[kPlain] + passed[kTextured] + passed[kMasked], room) << "seed " << seed;
  }
}

}  // namespace
}  // namespace standin
