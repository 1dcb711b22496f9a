#include "placement/candidates/tight_shaft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "render/base/rng.h"

namespace standin::test {
namespace {

bool encloses_all(const Shaft& shaft, const std::vector<Box>& cells) {
  for (const auto& cell : cells)
    if (!encloses(shaft, cell)) return false;
  return true;
}

void expect_tight(const Shaft& shaft, const std::vector<Box>& cells) {
  EXPECT_TRUE(encloses_all(shaft, cells));
  Shaft narrower = shaft;
  narrower.tan_half.x *= 1.0 - 1e-6;
  EXPECT_FALSE(encloses_all(narrower, cells)) << "along right";
  narrower = shaft;
  narrower.tan_half.y *= 1.0 - 1e-6;
  EXPECT_FALSE(encloses_all(narrower, cells)) << "along up";
  Shaft farther = shaft;
  farther.min_distance_m *= 1.0 + 1e-6;
  EXPECT_FALSE(encloses_all(farther, cells)) << "near plane";
}

TEST(TightShaft, OneCellStraightAhead) {
  // A square of side 2 from z = 10 to 12 on the axis: the near corners decide, at slope 1/10.
  const auto shaft = tight_shaft(Vec3(0.0), std::vector<Box>{{{-1.0, -1.0, 10.0}, {1.0, 1.0, 12.0}}});
  ASSERT_TRUE(shaft);
  EXPECT_NEAR(shaft->axis.z, 1.0, 1e-12);
  EXPECT_NEAR(shaft->tan_half.x, 0.1, 1e-9);
  EXPECT_NEAR(shaft->tan_half.y, 0.1, 1e-9);
  EXPECT_NEAR(shaft->min_distance_m, 10.0, 1e-7);
}

TEST(TightShaft, AimsAtTheMiddleOfWhatItServes) {
  // Three narrow cells at -30, 25 and 30 degrees: the mean direction is off, the middle is straight ahead.
  std::vector<Box> cells;
  for (const double deg : {-30.0, 25.0, 30.0}) {
    const double rad = deg * 0.017453292519943295;
    const Vec3 at(100.0 * std::sin(rad), 0.0, 100.0 * std::cos(rad));
    cells.push_back({at, at});
  }
  const auto shaft = tight_shaft(Vec3(0.0), cells);
  ASSERT_TRUE(shaft);
  EXPECT_NEAR(shaft->axis.x, 0.0, 1e-3);
  EXPECT_NEAR(shaft->tan_half.x, std::tan(30.0 * 0.017453292519943295), 1e-3);
}

TEST(TightShaft, ShrinkingExcludesACorner) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rng rng(seed);
    const double scale = std::exp(rng.uniform(-7.0, 7.0));
    const Vec3 apex = Vec3(rng.uniform(-1e4, 1e4), rng.uniform(-10.0, 10.0), rng.uniform(-1e4, 1e4));
    const Vec3 ahead = glm::normalize(Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-0.6, 0.6), rng.uniform(-1.0, 1.0)));
    std::vector<Box> cells;
    for (std::uint64_t i = rng.below(4); i < 5; ++i) {
      const Vec3 low = apex + scale * (20.0 * ahead + Vec3(rng.uniform(-5.0, 5.0), rng.uniform(-1.0, 1.0), rng.uniform(-5.0, 5.0)));
      cells.push_back({low, low + scale * Vec3(rng.uniform(0.1, 3.0), rng.uniform(0.0, 1.0), rng.uniform(0.1, 3.0))});
    }
    const auto shaft = tight_shaft(apex, cells);
    ASSERT_TRUE(shaft);
    expect_tight(*shaft, cells);
  }
}

TEST(TightShaft, NoneAroundTheApex) {
  EXPECT_FALSE(tight_shaft(Vec3(0.0), std::vector<Box>{{{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}}}));
  EXPECT_FALSE(tight_shaft(Vec3(0.0), std::vector<Box>{{{-1.0, -1.0, -1.0}, {2.0, 2.0, 5.0}}}));
  // Before and behind: no pyramid holds both.
  EXPECT_FALSE(tight_shaft(Vec3(0.0), std::vector<Box>{{{-1.0, -1.0, 9.0}, {1.0, 1.0, 10.0}}, {{-1.0, -1.0, -10.0}, {1.0, 1.0, -9.0}}}));
}

TEST(TightShaft, StraightUp) {
  const std::vector<Box> cells{{{-1.0, 10.0, -2.0}, {1.0, 11.0, 2.0}}};
  const auto shaft = tight_shaft(Vec3(0.0), cells);
  ASSERT_TRUE(shaft);
  expect_tight(*shaft, cells);
}

}  // namespace
}  // namespace standin::test
