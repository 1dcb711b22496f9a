// What filtering makes of a page: gaps and outlines under each sampling, worked out by hand.
#include <gtest/gtest.h>

#include "tests/server/verify/judged_panes.h"

namespace standin {
namespace {

using test::HandMadeQuad;
using test::judged;
using test::kFromOrigin;
using test::panes;

enum { kNearest, kBilinear, kMipmapped };

std::vector<ImpostorJudgement> judge(const HandMadeQuad& quad, const Camera& camera = test::kCamera) {
  const Scene scene = panes({{2.0, 10.0}});
  return judge_samplings(scene, test::read_back({quad}), judged(scene, {{10.0, 10.0, 10.0}}), camera, std::vector<View>{kFromOrigin},
                         kAlphaSamplings, 1, {});
}

TEST(SampledRays, AnOpaquePageStaysOpaque) {
  for (const auto& result : judge(HandMadeQuad{})) {
    EXPECT_EQ(result.gap_pixels, 0U);
    EXPECT_EQ(result.shown_pixels, 30U * 30U);
  }
}

// Alpha crosses one half on the border between opaque and transparent texels: straight outlines stay where they were; the corners' own
// texels lose a bit.
TEST(SampledRays, StraightOutlinesStay) {
  const auto inner = [](int x, int y) { return x >= 1 && x <= 16 && y >= 1 && y <= 16; };
  const auto results = judge({10.0, 0.225, 18, inner});
  EXPECT_EQ(results[kNearest].shown_pixels, 30U * 30U);
  EXPECT_GE(results[kBilinear].shown_pixels, 30U * 30U - 4U);
  EXPECT_EQ(results[kBilinear].excess_pixels, 0U);
  EXPECT_EQ(results[kBilinear].gap_pixels, 0U);
}

// Pixel centres of columns 32, 33 and rows 24, 25 lie in texel (8, 4), by (-0.241, 0.277) and (-0.383, 0.134) of a texel beside its centre.
// Alpha there is 1 - (1 - |x|) (1 - |y|): 0.532, 0.554 in row 24, 0.343, 0.374 in row 25. A pixel is 0.52 texels: nothing is minified.
TEST(SampledRays, AHoleShrinksUnderFiltering) {
  const auto results = judge({10.0, 0.2, 16, [](int x, int y) { return x != 8 || y != 4; }});
  EXPECT_EQ(results[kNearest].gap_pixels, 4U);
  EXPECT_EQ(results[kBilinear].gap_pixels, 2U);
  EXPECT_EQ(results[kMipmapped].gap_pixels, 2U);
}

// 2.1 and 2.8 texels a pixel, every fourth column transparent or opaque: the chain has 0.5 (just opaque) and 1, then 0.75; or 0 and 0.5,
// then 0.25.
TEST(SampledRays, MipmapsCloseThinHolesAndLoseThinLines) {
  const Camera coarse{0.78539816339744831, 16, 16, 0.1};
  const auto holes = judge({10.0, 0.2, 16, [](int x, int) { return x % 4 != 0; }}, coarse);
  EXPECT_GT(holes[kNearest].gap_pixels, 0U);
  EXPECT_EQ(holes[kMipmapped].gap_pixels, 0U);
  const auto lines = judge({10.0, 0.2, 32, [](int x, int) { return x % 4 == 0; }}, {0.78539816339744831, 24, 24, 0.1});
  EXPECT_LT(lines[kNearest].gap_pixels, lines[kNearest].pixels);
  EXPECT_EQ(lines[kMipmapped].gap_pixels, lines[kMipmapped].pixels);
}

// A texel of excess all around, 1.93 pixels wide, of which stripes are opaque: filtered to grey at half the size, it is bloat everywhere.
TEST(SampledRays, MipmapsFattenStripes) {
  const Camera coarse{0.78539816339744831, 24, 24, 0.1};
  const auto striped = [](int x, int) { return x % 2 == 0; };
  const auto results = judge({10.0, 0.3, 64, striped}, coarse);
  EXPECT_GT(results[kMipmapped].excess_pixels, results[kNearest].excess_pixels);
}

TEST(SampledRays, NearestIsWhatJudgeImpostorLooksAt) {
  const Scene scene = panes({{2.0, 10.0}});
  const auto quads = test::read_back({{10.0, 0.2, 16, [](int x, int y) { return (x * y) % 3 != 1; }}});
  const JudgedImpostor impostor = judged(scene, {{10.0, 10.0, 10.0}});
  const std::vector<View> views = {kFromOrigin, {Vec3(1, 1, 0), Vec3(0, 0, -1)}};
  const auto all = judge_samplings(scene, quads, impostor, test::kCamera, views, kAlphaSamplings, 2, {});
  const auto one = judge_impostor(scene, quads, impostor, test::kCamera, views, 1, {});
  ASSERT_EQ(all.size(), 3U);
  EXPECT_GT(one.gap_pixels, 0U);
  EXPECT_EQ(all[kNearest].gap_pixels, one.gap_pixels);
  EXPECT_EQ(all[kNearest].excess_pixels, one.excess_pixels);
  EXPECT_EQ(all[kNearest].max_parallax_ratio, one.max_parallax_ratio);
  EXPECT_NE(all[kBilinear].gap_pixels, one.gap_pixels);
}

}  // namespace
}  // namespace standin
