#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/base/rng.h"
#include "render/view/camera.h"

namespace standin {
namespace {

constexpr double kPi = std::numbers::pi;

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Vec3 random_direction(Rng& rng) {
  const double z = rng.uniform(-1, 1);
  const double turn = rng.uniform(0, 2 * kPi);
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(turn), radius * std::sin(turn), z};
}

TEST(Camera, AnglesOfANinetyDegreeImage) {
  const Camera camera{0.5 * kPi, 200, 100, 0.1};
  EXPECT_NEAR(camera.tan_half_y(), 1.0, 1e-15);
  EXPECT_NEAR(camera.tan_half_x(), 2.0, 1e-15);
  EXPECT_NEAR(camera.focal_px(), 50.0, 1e-12);
  EXPECT_NEAR(std::tan(camera.half_diagonal_rad()), std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(std::tan(0.5 * camera.pixel_angle_rad()), 0.01, 1e-15);
}

TEST(Camera, LooksAlongMinusZAsOpenGlDoes) {
  const Mat3 frame = world_from_eye_rotation(Vec3(0, 0, -1));
  expect_near(frame[0], Vec3(1, 0, 0));
  expect_near(frame[1], Vec3(0, 1, 0));
  expect_near(frame[2], Vec3(0, 0, 1));
}

TEST(Camera, PolesAreReachedAlongMinusZ) {
  for (const double y : {1.0, -1.0}) {
    const Mat3 pole = world_from_eye_rotation(Vec3(0, y, 0));
    const Mat3 beside = world_from_eye_rotation(glm::normalize(Vec3(0, y, -1e-8)));
    for (int i = 0; i < 3; ++i) expect_near(pole[i], beside[i], 1e-7);
    expect_near(pole[0], Vec3(1, 0, 0));
    const Mat3 noisy = world_from_eye_rotation(Vec3(6e-17, y, 0));  // cos(pi / 2) in double
    expect_near(noisy[0], Vec3(1, 0, 0));
  }
}

TEST(Camera, FramesAreOrthonormalRightHandedAndRollFree) {
  const std::uint64_t seed = 21;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 direction = random_direction(rng);
    const Mat3 frame = world_from_eye_rotation(direction);
    expect_near(frame[2], -direction);
    expect_near(glm::cross(frame[0], frame[1]), frame[2]);
    EXPECT_NEAR(glm::length(frame[0]), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(frame[1]), 1.0, 1e-12);
    EXPECT_EQ(frame[0].y, 0.0);  // no roll
    EXPECT_GE(frame[1].y, 0.0);  // and not upside down
  }
}

TEST(Camera, EyeSpaceHasTheViewAtItsOrigin) {
  const View view{Vec3(3, 4, 5), glm::normalize(Vec3(1, 0.5, -2))};
  const Mat4 eye = eye_from_world(view);
  expect_near(Vec3(eye * Vec4(view.position, 1.0)), Vec3(0.0));
  expect_near(Vec3(eye * Vec4(view.position + 7.0 * view.direction, 1.0)), Vec3(0, 0, -7));
}

TEST(Camera, ClipSpaceHasOpenGlsBorders) {
  const Camera camera{0.5 * kPi, 200, 100, 0.25};
  const auto ndc = [&](const Vec3& eye) {
    const Vec4 clip = clip_from_eye(camera) * Vec4(eye, 1.0);
    return Vec3(clip) / clip.w;
  };
  expect_near(ndc(Vec3(0, 0, -0.25)), Vec3(0, 0, -1));
  expect_near(ndc(Vec3(20, 10, -10)), Vec3(1, 1, 1.0 - 0.5 / 10.0));
  expect_near(ndc(Vec3(-2e9, -1e9, -1e9)), Vec3(-1, -1, 1), 1e-9);
}

TEST(Frustum, PlanesAgreeWithTheProjection) {
  const std::uint64_t seed = 22;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  const Camera camera{1.0, 320, 200, 0.1};
  int inside_count = 0;
  for (int i = 0; i < 20'000; ++i) {
    const View view{Vec3(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)), random_direction(rng)};
    const Vec3 point = view.position + rng.uniform(0.1, 10) * random_direction(rng);
    const Vec4 clip = clip_from_eye(camera) * eye_from_world(view) * Vec4(point, 1.0);
    const bool projected = clip.w > 0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w;
    EXPECT_EQ(may_intersect(frustum_of(view, camera), Box{point, point}), projected);
    inside_count += projected ? 1 : 0;
  }
  EXPECT_GT(inside_count, 500);
}

}  // namespace
}  // namespace standin
