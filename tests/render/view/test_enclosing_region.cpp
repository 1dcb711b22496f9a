#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "render/base/rng.h"
#include "render/view/enclosing_region.h"

namespace standin {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 random_direction(Rng& rng) {
  const double z = rng.uniform(-1, 1);
  const double turn = rng.uniform(0, 2 * kPi);
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(turn), z, radius * std::sin(turn)};
}

// Half the draws lie on a border: that is where a region that is too small leaks.
double pushed(Rng& rng, double low, double high) {
  const auto choice = rng.below(4);
  return choice == 0 ? low : choice == 1 ? high : rng.uniform(low, high);
}

Vec3 pushed_point(Rng& rng, const Box& box) {
  return {pushed(rng, box.min.x, box.max.x), pushed(rng, box.min.y, box.max.y), pushed(rng, box.min.z, box.max.z)};
}

DirectionInterval random_interval(Rng& rng) {
  const int level = static_cast<int>(rng.below(7));
  const auto count = std::uint64_t{1} << level;
  return {static_cast<Face>(rng.below(6)), level, static_cast<int>(rng.below(count)), static_cast<int>(rng.below(count))};
}

Camera random_camera(Rng& rng, double widest_deg) {
  return {rng.uniform(5.0, widest_deg) * kPi / 180.0, static_cast<int>(100 + rng.below(900)), static_cast<int>(100 + rng.below(900)), 0.1};
}

Box random_box(Rng& rng, double far, double wide) {
  const Vec3 corner = far * Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  return {corner, corner + wide * rng.uniform() * Vec3(rng.uniform(), rng.uniform(), rng.uniform())};
}

// A ray of the frustum of a random view of the interval.
Vec3 random_frustum_ray(Rng& rng, const DirectionInterval& interval, const Camera& camera) {
  const auto [a0, a1, b0, b1] = interval.angles_rad();
  const Vec3 direction = direction_at(interval.face, pushed(rng, a0, a1), pushed(rng, b0, b1));
  const Mat3 frame = world_from_eye_rotation(direction);
  return direction + pushed(rng, -1, 1) * camera.tan_half_x() * frame[0] + pushed(rng, -1, 1) * camera.tan_half_y() * frame[1];
}

void expect_all_contained(std::uint64_t seed, int regions, double widest_deg, const std::function<DirectionInterval(Rng&)>& choose) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  for (int k = 0; k < regions; ++k) {
    const DirectionInterval interval = choose(rng);
    const Camera camera = random_camera(rng, widest_deg);
    const DirectionCone cone = enclosing_cone(interval, camera);
    const Box positions = random_box(rng, 100.0, 50.0);
    for (int i = 0; i < 400; ++i) {
      const double distance = std::pow(10.0, rng.uniform(-2, 5));
      const Vec3 point = pushed_point(rng, positions) + distance * random_frustum_ray(rng, interval, camera);
      ASSERT_TRUE(contains(cone, positions, point))
          << "region " << k << ", face " << face_frame(interval.face).name << ", level " << interval.level << " (" << interval.i << ", "
          << interval.j << "), fov " << camera.fov_y_rad << ", distance " << distance;
    }
  }
}

TEST(EnclosingRegion, ContainsEveryFrustumPoint) {
  expect_all_contained(51, 600, 97.0, random_interval);
}

TEST(EnclosingRegion, ContainsEveryFrustumPointOfWideFields) {
  expect_all_contained(52, 300, 150.0, random_interval);
}

TEST(EnclosingRegion, ContainsEveryFrustumPointAtThePoles) {
  expect_all_contained(53, 200, 120.0, [](Rng& rng) {
    const int level = static_cast<int>(1 + rng.below(7));
    const int middle = 1 << (level - 1);
    return DirectionInterval{rng.below(2) == 0 ? Face::kPosY : Face::kNegY, level, middle - static_cast<int>(rng.below(2)),
                             middle - static_cast<int>(rng.below(2))};
  });
}

// Two planes bound the front (the one across the axis and the horizon); the rest are those of the roll-free camera.
TEST(EnclosingRegion, HasNoRollFreePlanesAtThePoles) {
  for (const Face face : {Face::kPosY, Face::kNegY}) {
    EXPECT_EQ(enclosing_cone(DirectionInterval{face, 3, 4, 4}, Camera{}).plane_normals.size(), 2U);
    EXPECT_GT(enclosing_cone(DirectionInterval{face, 3, 0, 0}, Camera{}).plane_normals.size(), 5U);
  }
  EXPECT_EQ(enclosing_cone(DirectionInterval{Face::kPosX, 3, 4, 4}, Camera{}).plane_normals.size(), 10U);
}

TEST(EnclosingRegion, WideFieldsAreEverything) {
  const DirectionCone cone = enclosing_cone(DirectionInterval{Face::kPosX, 0, 0, 0}, Camera{2.6, 512, 512, 0.1});
  EXPECT_GE(cone.half_angle_rad, 0.5 * kPi);
  const Box eye{Vec3(0.0), Vec3(1.0)};
  EXPECT_TRUE(contains(cone, eye, Vec3(-1000, 3, 5)));
}

TEST(EnclosingRegion, AlwaysHoldsThePositionsThemselves) {
  const Box positions{Vec3(1e6, -5, 3), Vec3(1e6 + 20, 5, 30)};
  const DirectionCone cone = enclosing_cone(DirectionInterval{Face::kNegZ, 4, 3, 9}, Camera{});
  EXPECT_TRUE(may_see(cone, positions, positions));
  EXPECT_TRUE(may_see(cone, positions, Box{positions.min, positions.min}));
  EXPECT_TRUE(contains(cone, positions, positions.centre()));
}

// By hand: eyes at the origin, level 4 about +x (5.625 degrees from the axis), 45 degrees square. In the plane y = 0 the frusta reach from
// -22.5 to 28.125 degrees along u.
TEST(EnclosingRegion, IsTightAcrossTheHorizon) {
  const DirectionInterval interval{Face::kPosX, 4, 8, 8};
  const DirectionCone cone = enclosing_cone(interval, Camera{});
  const Box eye{Vec3(0.0), Vec3(0.0)};
  const auto seen_at = [&](double angle_deg) { return contains(cone, eye, direction_at(Face::kPosX, angle_deg * kPi / 180.0, 0.0)); };
  EXPECT_TRUE(seen_at(28.1));
  EXPECT_TRUE(seen_at(-22.4));
  EXPECT_FALSE(seen_at(28.125 + 3.0));
  EXPECT_FALSE(seen_at(-22.5 - 3.0));
}

// Share of the sphere accepted from a point, against that of frusta drawn at random (math.md 4: about 1.13 at 11.25 degrees).
TEST(EnclosingRegion, IsHardlyWiderThanTheUnionOfFrusta) {
  const std::uint64_t seed = 54;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  const DirectionInterval interval{Face::kPosZ, 3, 5, 2};
  const Camera camera;
  const DirectionCone cone = enclosing_cone(interval, camera);
  std::vector<Frustum> frusta;
  const auto [a0, a1, b0, b1] = interval.angles_rad();
  for (int i = 0; i < 400; ++i)
    frusta.push_back(frustum_of(View{Vec3(0.0), direction_at(interval.face, pushed(rng, a0, a1), pushed(rng, b0, b1))}, camera));
  int accepted = 0;
  int seen = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 direction = random_direction(rng);
    const Box point{direction, direction};
    accepted += may_see(cone, Box{Vec3(0.0), Vec3(0.0)}, point) ? 1 : 0;
    seen += std::any_of(frusta.begin(), frusta.end(), [&](const auto& planes) { return may_intersect(planes, point); }) ? 1 : 0;
  }
  EXPECT_GE(accepted, seen);
  EXPECT_LT(accepted, 1.25 * seen);
}

// A box is kept if any of many sampled views sees any of many of its points; and the test does reject.
TEST(EnclosingRegion, RejectsNoBoxThatASampledViewSees) {
  const std::uint64_t seed = 55;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  int rejected = 0;
  int seen_boxes = 0;
  for (int k = 0; k < 1500; ++k) {
    const DirectionInterval interval = random_interval(rng);
    const Camera camera = random_camera(rng, k % 3 == 0 ? 150.0 : 70.0);
    const DirectionCone cone = enclosing_cone(interval, camera);
    const Box positions = random_box(rng, 30.0, 20.0);
    const Box box = random_box(rng, 80.0, 60.0);
    const bool kept = may_see(cone, positions, box);
    rejected += kept ? 0 : 1;
    bool seen = false;
    for (int i = 0; i < 200 && !seen; ++i) {
      const auto [a0, a1, b0, b1] = interval.angles_rad();
      const View view{pushed_point(rng, positions), direction_at(interval.face, pushed(rng, a0, a1), pushed(rng, b0, b1))};
      const Vec3 point = pushed_point(rng, box);
      seen = may_intersect(frustum_of(view, camera), Box{point, point});
    }
    seen_boxes += seen ? 1 : 0;
    ASSERT_TRUE(kept || !seen) << "region " << k;
  }
  EXPECT_GT(rejected, 300);
  EXPECT_GT(seen_boxes, 300);
}

// Straight up, where only the cone and the horizon bound the region: it reaches 46.2 degrees from the zenith towards (+x, -z).
TEST(EnclosingRegion, RejectsBoxesBesideTheConeAndBelowIt) {
  const DirectionCone cone = enclosing_cone(DirectionInterval{Face::kPosY, 3, 4, 4}, Camera{});
  const Box eye{Vec3(0.0), Vec3(0.0)};
  const auto at = [](double angle_deg) {
    const double angle_rad = angle_deg * kPi / 180.0;
    const Vec3 centre = 100.0 * (std::cos(angle_rad) * Vec3(0, 1, 0) + std::sin(angle_rad) * glm::normalize(Vec3(1, 0, -1)));
    return Box{centre - Vec3(0.5), centre + Vec3(0.5)};
  };
  EXPECT_TRUE(may_see(cone, eye, at(46.0)));
  EXPECT_FALSE(may_see(cone, eye, at(47.0)));
  EXPECT_FALSE(may_see(cone, eye, at(-30.0 - 1.0)));
  EXPECT_FALSE(may_see(cone, eye, Box{Vec3(-500, -20, -500), Vec3(500, -1, 500)}));
}

}  // namespace
}  // namespace standin
