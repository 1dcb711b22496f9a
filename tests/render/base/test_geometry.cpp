#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/base/geometry.h"
#include "render/base/rng.h"

namespace standin {
namespace {

Box random_box(Rng& rng) {
  Box box;
  for (int i = 0; i < 2; ++i) box.extend(Vec3(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-5, 5)));
  return box;
}

TEST(Box, IsEmptyUntilExtended) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0.0);
  box.extend(Vec3(1, 2, 3));
  EXPECT_FALSE(box.empty());
  EXPECT_TRUE(box.contains(Vec3(1, 2, 3)));
  EXPECT_FALSE(box.contains(Vec3(1, 2, 3.001)));
}

TEST(Box, CornersAreNumberedByBits) {
  const Box box{Vec3(0, 1, 2), Vec3(3, 4, 5)};
  EXPECT_EQ(box.corner(0), Vec3(0, 1, 2));
  EXPECT_EQ(box.corner(1), Vec3(3, 1, 2));
  EXPECT_EQ(box.corner(2), Vec3(0, 4, 2));
  EXPECT_EQ(box.corner(4), Vec3(0, 1, 5));
  EXPECT_EQ(box.corner(7), Vec3(3, 4, 5));
}

TEST(Box, SupportIsTheGreatestCorner) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  for (int i = 0; i < 1000; ++i) {
    const Box box = random_box(rng);
    const Vec3 normal(rng.uniform(-1, 1), rng.uniform(-1, 1), i % 3 == 0 ? 0.0 : rng.uniform(-1, 1));
    double greatest = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) greatest = std::max(greatest, glm::dot(normal, box.corner(k)));
    EXPECT_DOUBLE_EQ(box.support(normal), greatest);
  }
}

TEST(Box, DistanceOfSeparatedTouchingAndOverlappingBoxes) {
  const Box unit{Vec3(0.0), Vec3(1.0)};
  EXPECT_DOUBLE_EQ(distance(unit, Box{Vec3(4, 5, 0), Vec3(6, 6, 1)}), 5.0);  // a 3-4-5 triangle between the edges
  EXPECT_EQ(distance(unit, Box{Vec3(1, 0, 0), Vec3(2, 1, 1)}), 0.0);
  EXPECT_EQ(distance(unit, Box{Vec3(0.5), Vec3(3.0)}), 0.0);
  EXPECT_DOUBLE_EQ(distance(Vec3(0.5, 0.5, -2.0), unit), 2.0);
}

TEST(Box, IntersectionOfDisjointBoxesIsEmpty) {
  EXPECT_TRUE(intersection(Box{Vec3(0.0), Vec3(1.0)}, Box{Vec3(2.0), Vec3(3.0)}).empty());
  EXPECT_EQ(intersection(Box{Vec3(0.0), Vec3(2.0)}, Box{Vec3(1.0), Vec3(3.0)}), (Box{Vec3(1.0), Vec3(2.0)}));
}

TEST(Box, TransformedBoxHoldsTheTransformedPoints) {
  const Mat4 quarter_turn = glm::rotate(Mat4(1.0), 0.5 * std::acos(-1.0), Vec3(0, 1, 0));  // x goes to -z
  const Box turned = transformed(quarter_turn, Box{Vec3(1, 0, 0), Vec3(2, 1, 3)});
  EXPECT_NEAR(turned.min.x, 0.0, 1e-12);
  EXPECT_NEAR(turned.max.x, 3.0, 1e-12);
  EXPECT_NEAR(turned.min.z, -2.0, 1e-12);
  EXPECT_NEAR(turned.max.z, -1.0, 1e-12);
  EXPECT_TRUE(transformed(quarter_turn, Box{}).empty());
}

}  // namespace
}  // namespace standin
