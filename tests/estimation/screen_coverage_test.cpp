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
  coverage.add(PixelKind::kPlain, 16.0, 16.0, 500.0);
  coverage.add(PixelKind::kTextured, 16.0, 16.0, 300.0);
  coverage.add(PixelKind::kMasked, 16.0, 16.0, 200.0);
  EXPECT_EQ(coverage.passed(), (std::array{500.0, 300.0, 200.0}));
}

// Twice what fits, one part plain and three textured: both give way alike, and nothing is left for what is masked.
TEST(ScreenCoverage, ShareAFullCell) {
  ScreenCoverage coverage(kCamera);
  const double full = kOverdraw * kCellPixels;
  for (int i = 0; i < 8; ++i) coverage.add(i < 2 ? PixelKind::kPlain : PixelKind::kTextured, 16.0, 16.0, 0.25 * full);
  coverage.add(PixelKind::kMasked, 16.0, 16.0, 100.0);
  EXPECT_NEAR(coverage.passed()[kPlain], 0.25 * full, 1e-9);
  EXPECT_NEAR(coverage.passed()[kTextured], 0.75 * full, 1e-9);
  EXPECT_EQ(coverage.passed()[kMasked], 0.0);
}

TEST(ScreenCoverage, MaskedPixelsGetWhatOpaqueOnesLeave) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 16.0, 16.0, 1000.0);
  coverage.add(PixelKind::kMasked, 16.0, 16.0, 1000.0);
  EXPECT_NEAR(coverage.passed()[kMasked], kOverdraw * kCellPixels - 1000.0, 1e-9);
}

TEST(ScreenCoverage, CellsDoNotHideEachOther) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 16.0, 16.0, 1000.0);
  coverage.add(PixelKind::kPlain, 48.0, 16.0, 1000.0);
  coverage.add(PixelKind::kPlain, 500.0, 500.0, 1000.0);
  EXPECT_NEAR(coverage.passed()[kPlain], 3000.0, 1e-9);
}

// A square of 64 x 64 pixels in the middle of four cells lies in all of them.
TEST(ScreenCoverage, ALargeSquareSpreadsOverItsCells) {
  ScreenCoverage coverage(kCamera);
  coverage.add(PixelKind::kPlain, 32.0, 32.0, 4000.0);
  EXPECT_NEAR(coverage.passed()[kPlain], 4000.0, 1e-9);
  for (const auto& [x, y] : {std::pair{16.0, 16.0}, {48.0, 16.0}, {16.0, 48.0}, {48.0, 48.0}})
    coverage.add(PixelKind::kMasked, x, y, 1000.0);
  EXPECT_NEAR(coverage.passed()[kMasked], 4.0 * (kOverdraw * kCellPixels - 1000.0), 1e-6);
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
      coverage.add(static_cast<PixelKind>(kind), rng.uniform(-10.0, 2010.0), rng.uniform(-10.0, 2010.0), pixels);
      generated[kind] += pixels;
    }
    double sum = 0.0;
    for (std::size_t kind = 0; kind < kPixelKindCount; ++kind) {
      ASSERT_LE(coverage.passed()[kind], generated[kind] * (1.0 + 1e-12)) << "seed " << seed;
      sum += coverage.passed()[kind];
    }
    ASSERT_LE(sum, kOverdraw * camera.width * camera.height * (1.0 + 1e-12)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace standin
