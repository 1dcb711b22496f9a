#include "estimation/gaze.h"

#include <gtest/gtest.h>

#include "estimation/projection.h"
#include "render/view/direction_interval.h"
#include "small_scenes.h"

namespace standin {
namespace {

using test::random_unit;

/// A view of a random region, and a point that it sees.
struct SeenPoint {
  Camera camera;
  Box eyes;
  DirectionInterval interval;
  View view;
  Vec3 point{0.0};

  explicit SeenPoint(Rng& rng) {
    camera.fov_y_rad = std::pow(10.0, rng.uniform(-1.7, 0.4));  // 1 to 144 degrees
    camera.width = rng.below(2) == 0 ? 512 : 1024;
    interval = interval_of(random_unit(rng), static_cast<int>(rng.below(6)));
    const auto [a0, a1, b0, b1] = interval.angles_rad();
    const Vec3 size = std::pow(10.0, rng.uniform(-3.0, 1.5)) * Vec3(rng.uniform(), rng.below(2) * rng.uniform(), rng.uniform());
    const Vec3 low(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9));
    eyes = {low, low + size};
    const Vec3 share(rng.uniform(), rng.below(2), rng.uniform());
    const double a = rng.below(4) == 0 ? a0 : rng.uniform(a0, a1);
    view = {low + share * size, direction_at(interval.face, a, rng.uniform(b0, b1))};
    const double depth_m = camera.near_m + std::pow(10.0, rng.uniform(-2.0, 3.0));
    const double across = rng.below(3) == 0 ? 1.0 : rng.uniform(-1.0, 1.0);  // often in the image's border
    point = view.position + world_from_eye_rotation(view.direction) *
                                (depth_m * Vec3(across * camera.tan_half_x(), rng.uniform(-1.0, 1.0) * camera.tan_half_y(), -1.0));
  }
  [[nodiscard]] double cosine() const { return glm::dot(glm::normalize(point - view.position), view.direction); }
};

/// Of one patch; nothing where no view sees it.
std::optional<double> least_cosine(const Gaze& gaze, const Vec3& point, double reach_m, const Box& eyes) {
  Bearings one;
  one.set(3, point, reach_m, eyes);
  one.look_from(eyes);
  LaneRow cosines;
  gaze.least_cosines(one, ~0U, cosines);
  return cosines[3] > 0.0 ? std::optional(cosines[3]) : std::nullopt;
}

TEST(Gaze, HoldsEveryPointThatAViewOfTheRegionSees) {
  for (std::uint64_t seed = 0; seed < 20000; ++seed) {
    Rng rng(seed, 11);
    const SeenPoint seen(rng);
    const DirectionCone cone = enclosing_cone(seen.interval, seen.camera);
    const Gaze gaze(cone, seen.eyes, seen.camera);
    const auto exact = least_cosine(gaze, seen.point, 0.0, seen.eyes);
    ASSERT_TRUE(exact) << "seed " << seed;
    ASSERT_LE(*exact, seen.cosine() + 1e-9) << "seed " << seed;
    const double reach_m = std::pow(10.0, rng.uniform(-2.0, 1.0));
    const Vec3 centre = seen.point + rng.uniform() * reach_m * random_unit(rng);
    const auto of_patch = least_cosine(gaze, centre, reach_m, seen.eyes);
    ASSERT_TRUE(of_patch) << "seed " << seed;
    ASSERT_LE(*of_patch, seen.cosine() + 1e-9) << "seed " << seed;
  }
}

// One eye, directions within half a degree of -z, 45 degrees to the image's sides: what is left out and how deep the rest lies.
TEST(Gaze, OfOneEyeIsItsFrustum) {
  Camera camera;
  camera.fov_y_rad = glm::radians(90.0);
  const Box eye{Vec3(0.0), Vec3(0.0)};
  const DirectionInterval ahead = interval_of({1e-9, 1e-9, -1.0}, 7);  // 0.7 degrees wide
  const DirectionCone cone = enclosing_cone(ahead, camera);
  const Gaze gaze(cone, eye, camera);
  const auto cosine = [&](double right, double up, double back) { return least_cosine(gaze, {right, up, back}, 0.0, eye); };
  ASSERT_TRUE(cosine(0.0, 0.0, -5.0));
  EXPECT_GT(*cosine(0.0, 0.0, -5.0), std::cos(glm::radians(1.5)));
  ASSERT_TRUE(cosine(3.0, 0.0, -5.0));
  EXPECT_NEAR(*cosine(3.0, 0.0, -5.0), 5.0 / std::sqrt(34.0), 0.015);
  EXPECT_FALSE(cosine(0.0, 0.0, 5.0));
  EXPECT_FALSE(cosine(0.0, 5.3, -5.0));  // 46.7 degrees
  EXPECT_FALSE(cosine(5.3, 0.0, -5.0));
  // Nearly in the corner, 54.2 of 54.7 degrees off the direction that is farthest from it.
  ASSERT_TRUE(cosine(4.9, 4.9, -5.0));
  EXPECT_NEAR(*cosine(4.9, 4.9, -5.0), 5.0 / std::sqrt(2.0 * 4.9 * 4.9 + 25.0), 1e-4);
  EXPECT_TRUE(least_cosine(gaze, {5.3, 0.0, -5.0}, 0.3, eye));  // a part of it
}

TEST(Gaze, OfEyesAllAroundMayBeAnywhere) {
  const Camera camera;
  const Box eyes{Vec3(-10.0), Vec3(10.0)};
  const DirectionCone cone = enclosing_cone(interval_of({1.0, 0.2, 0.1}, 3), camera);
  const auto cosine = least_cosine(Gaze(cone, eyes, camera), Vec3(1.0), 0.0, eyes);
  ASSERT_TRUE(cosine);
  EXPECT_EQ(*cosine, std::cos(camera.half_diagonal_rad()));
}

}  // namespace
}  // namespace standin
