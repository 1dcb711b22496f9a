#include "render/scene/region.h"

#include <gtest/gtest.h>

#include <numbers>

namespace standin {
namespace {

Path square(double low, double high) {
  return {{low, low}, {high, low}, {high, high}, {low, high}};
}

double area_of(const std::array<Vec2, 3>& t) {
  return std::abs(signed_area({t[0], t[1], t[2]}));
}

double sum_of_triangles(const Region& region) {
  double sum = 0.0;
  for (const auto& triangle : region.triangles()) sum += area_of(triangle);
  return sum;
}

TEST(Region, TrianglesCoverAPolygonAndLeaveItsHoleOpen) {
  const Region ring = Region::of({square(0, 10), {square(3, 6)}});
  EXPECT_DOUBLE_EQ(ring.area_m2(), 91.0);
  EXPECT_NEAR(sum_of_triangles(ring), 91.0, 1e-9);
  EXPECT_EQ(ring.triangles().size(), 8U) << "8 corners and a hole: no vertex was added";
  for (const auto& t : ring.triangles()) {
    const Vec2 middle = (t[0] + t[1] + t[2]) / 3.0;
    EXPECT_FALSE(middle.x > 3 && middle.x < 6 && middle.y > 3 && middle.y < 6);
  }
  EXPECT_TRUE(ring.contains({1, 1}));
  EXPECT_FALSE(ring.contains({4, 4}));
  EXPECT_FALSE(ring.contains({11, 4}));
}

TEST(Region, WindingIsOfNoConsequence) {
  for (const bool turned : {false, true}) {
    Polygon polygon{square(0, 10), {square(3, 6)}};
    if (turned) {
      std::reverse(polygon.shell.begin(), polygon.shell.end());
      std::reverse(polygon.holes[0].begin(), polygon.holes[0].end());
    }
    EXPECT_DOUBLE_EQ(Region::of(polygon).area_m2(), 91.0);
  }
}

TEST(Region, BrokenRingsAreMadeValid) {
  const Region bow = Region::of({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}, {}});
  EXPECT_DOUBLE_EQ(bow.area_m2(), 50.0);
  EXPECT_EQ(bow.polygons().size(), 2U);
  EXPECT_NEAR(sum_of_triangles(bow), 50.0, 1e-9);
  EXPECT_EQ(Region::of({{{0, 0}, {10, 0}}, {}}).area_m2(), 0.0);
  EXPECT_EQ(Region::of({{{0, 0}, {10, 0}, {20, 0}}, {}}).area_m2(), 0.0);
  EXPECT_TRUE(Region::of({{{0, 0}, {10, 0}, {20, 0}}, {}}).triangles().empty());
}

TEST(Region, OverlaysAddUp) {
  const Region a = Region::of({square(0, 10), {}});
  const Region b = Region::of({square(5, 15), {}});
  std::vector<Region> both;
  both.push_back(a.grown(0.0));
  both.push_back(b.grown(0.0));
  EXPECT_NEAR(Region::united(both).area_m2(), 175.0, 1e-9);
  EXPECT_NEAR(a.common(b).area_m2(), 25.0, 1e-9);
  EXPECT_NEAR(a.minus(b).area_m2(), 75.0, 1e-9);
  EXPECT_NEAR(a.within({{2, 2}, {4, 20}}).area_m2(), 16.0, 1e-9);
  const Region beside = Region::of({{{10, 0}, {20, 0}, {20, 10}, {10, 10}}, {}});
  EXPECT_EQ(a.common(beside).area_m2(), 0.0) << "they only touch";
  EXPECT_TRUE(a.common(beside).polygons().empty());
  EXPECT_EQ(Region::united({}).area_m2(), 0.0);
}

TEST(Region, StripsAroundLines) {
  const double area = Region::around({{0, 0}, {100, 0}}, 5.0).area_m2();
  EXPECT_GT(area, 1000.0);
  EXPECT_LT(area, 1000.0 + 25.0 * std::numbers::pi);
  EXPECT_EQ(Region::around({{0, 0}}, 5.0).area_m2(), 0.0);
}

}  // namespace
}  // namespace standin
