#include <gtest/gtest.h>

#include <cstdio>

#include "server/verify/impostor_rays.h"

namespace standin {
namespace {

Shaft shaft_of(const Vec3& apex) {
  Shaft shaft = shaft_frame(apex, glm::normalize(Vec3(1, 0.2, -2)));
  shaft.tan_half = Vec2(0.4, 0.1);
  shaft.min_distance_m = 30.0;
  return shaft;
}

void expect_inside_and_aimed(const ViewCell& cell, const Box& target) {
  for (const View& view : sample_cell_views(cell, target, 400, 7)) {
    EXPECT_TRUE(encloses(cell, view.position));
    EXPECT_NEAR(glm::length(view.direction), 1.0, 1e-12);
    const double distance = glm::length(target.centre() - view.position);
    const Vec3 nearest = view.position + glm::dot(target.centre() - view.position, view.direction) * view.direction;
    EXPECT_LE(glm::length(nearest - target.centre()), 0.5 * target.diagonal() * (1.0 + 1e-9)) << distance;
  }
}

TEST(CellViews, LieInTheViewCellAndLookAtTheTarget) {
  const Box target{Vec3(95, -5, 1), Vec3(105, 9, 11)};
  expect_inside_and_aimed(shaft_of(target.centre()), target);
  expect_inside_and_aimed(Box{Vec3(20, -5, -30), Vec3(40, 10, -10)}, target);
}

TEST(CellViews, VisitCornersNearBorderSidesAndDepth) {
  const Shaft shaft = shaft_of(Vec3(0.0));
  const auto views = sample_cell_views(shaft, Box{Vec3(-5.0), Vec3(5.0)}, 400, 7);
  int corners = 0;
  int near = 0;
  int sides = 0;
  double deepest = 0.0;
  for (const View& view : views) {
    const double along = glm::dot(view.position, shaft.axis);
    const Vec2 across = Vec2(glm::dot(view.position, shaft.right), glm::dot(view.position, shaft.up)) / (along * shaft.tan_half);
    const bool at_x = std::abs(std::abs(across.x) - 1.0) < 1e-9;
    const bool at_y = std::abs(std::abs(across.y) - 1.0) < 1e-9;
    const bool at_near = std::abs(along - 30.0) < 1e-9;
    corners += at_near && at_x && at_y ? 1 : 0;
    near += at_near ? 1 : 0;
    sides += at_x || at_y ? 1 : 0;
    deepest = std::max(deepest, along);
  }
  EXPECT_EQ(corners, 100);
  EXPECT_EQ(near, 200);
  EXPECT_GE(sides, 200);
  EXPECT_GT(deepest, 300.0);
}

TEST(CellViews, NearBorderOfABoxFacesTheTarget) {
  const Box cell{Vec3(0.0), Vec3(10.0)};
  const auto views = sample_cell_views(cell, Box{Vec3(-60, 2, 2), Vec3(-50, 8, 8)}, 40, 7);
  for (std::size_t i = 1; i < views.size(); i += 4) EXPECT_EQ(views[i].position.x, 0.0);
}

}  // namespace
}  // namespace standin
