#include <gtest/gtest.h>

#include <cmath>

#include "render/base/rng.h"
#include "render/view/view_cell.h"

namespace standin {
namespace {

Shaft upright_shaft() {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(1.0, 0.5);
  shaft.min_distance_m = 2.0;
  return shaft;
}

TEST(ShaftFrame, IsOrthonormalWithUpNearTheWorlds) {
  const std::uint64_t seed = 41;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = glm::normalize(Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)));
    const Shaft shaft = shaft_frame(Vec3(1, 2, 3), axis);
    EXPECT_NEAR(glm::length(glm::cross(shaft.up, shaft.axis) - shaft.right), 0.0, 1e-12);
    EXPECT_NEAR(glm::length(shaft.up), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(shaft.right, axis), 0.0, 1e-12);
    // The component of world y across the axis is the greatest any unit vector across the axis can have.
    EXPECT_NEAR(shaft.up.y, std::sqrt(1.0 - axis.y * axis.y), 1e-12);
  }
}

TEST(ShaftFrame, PointsUpToMinusZAtThePoles) {
  EXPECT_EQ(shaft_frame(Vec3(0.0), Vec3(0, 1, 0)).up, Vec3(0, 0, -1));
  EXPECT_EQ(shaft_frame(Vec3(0.0), Vec3(0, -1, 0)).up, Vec3(0, 0, -1));
}

TEST(ViewCell, ShaftIsAPyramidCutByItsNearPlane) {
  const ViewCell cell = upright_shaft();
  EXPECT_TRUE(encloses(cell, Vec3(0, 0, 2)));
  EXPECT_FALSE(encloses(cell, Vec3(0, 0, 1.999)));
  EXPECT_TRUE(encloses(cell, Vec3(4, 2, 4)));  // on the edge
  EXPECT_FALSE(encloses(cell, Vec3(4.001, 2, 4)));
  EXPECT_FALSE(encloses(cell, Vec3(4, 2.001, 4)));
  EXPECT_FALSE(encloses(cell, Vec3(0, 0, -5)));
  EXPECT_TRUE(encloses(cell, Vec3(1e6, 0, 1e6)));  // open at the far end
}

TEST(ViewCell, EnclosesABoxOnlyWithAllItsCorners) {
  const ViewCell cell = upright_shaft();
  const Box inside{Vec3(-4, -2, 4), Vec3(4, 2, 9)};
  EXPECT_TRUE(encloses(cell, inside));
  for (int axis = 0; axis < 3; ++axis) {
    Box pushed = inside;
    pushed.min[axis] -= axis == 2 ? 0.1 : 1e-6;  // along z the sides give way first
    EXPECT_FALSE(encloses(cell, pushed)) << axis;
  }
  EXPECT_FALSE(encloses(cell, Box{}));
}

TEST(ViewCell, BoxIsClosed) {
  const ViewCell cell = Box{Vec3(0.0), Vec3(1.0)};
  EXPECT_TRUE(encloses(cell, Box{Vec3(0.0), Vec3(1.0)}));
  EXPECT_FALSE(encloses(cell, Box{Vec3(0.0), Vec3(1.0, 1.0, 1.0001)}));
  EXPECT_FALSE(encloses(cell, Vec3(-1e-9, 0, 0)));
  EXPECT_FALSE(encloses(cell, Box{}));
}

// A shaft whose aperture and near plane are just those of a box's corners holds the box, whatever the rounding.
TEST(ViewCell, TightenedShaftsKeepTheirCells) {
  const std::uint64_t seed = 42;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  for (int k = 0; k < 2000; ++k) {
    const double scale = std::pow(10.0, rng.uniform(-1, 6));
    Shaft shaft = shaft_frame(scale * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)),
                              glm::normalize(Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1))));
    const Vec3 centre = shaft.apex + rng.uniform(40, 100) * shaft.axis;
    const Box cell{centre - Vec3(rng.uniform(0, 10)), centre + Vec3(rng.uniform(0, 10))};
    shaft.min_distance_m = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
      const Vec3 q = cell.corner(i) - shaft.apex;
      const double along = glm::dot(q, shaft.axis);
      shaft.min_distance_m = std::min(shaft.min_distance_m, along);
      shaft.tan_half = glm::max(shaft.tan_half, Vec2(std::abs(glm::dot(q, shaft.right)), std::abs(glm::dot(q, shaft.up))) / along);
    }
    EXPECT_TRUE(encloses(shaft, cell));
    shaft.tan_half.x *= 1.0 - 1e-6;
    EXPECT_FALSE(encloses(shaft, cell));
  }
}

}  // namespace
}  // namespace standin
