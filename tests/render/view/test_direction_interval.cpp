#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/view/direction_interval.h"

namespace standin {
namespace {

constexpr double kEighthTurn = 0.25 * std::numbers::pi;

double sine_between(const Vec3& a, const Vec3& b) {
  return glm::length(glm::cross(a, b));
}

TEST(FaceFrame, NamesAndAxesAgree) {
  const std::array<Vec3, 6> normals = {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)};
  const std::array<std::string, 6> names = {"+x", "-x", "+y", "-y", "+z", "-z"};
  for (std::size_t i = 0; i < 6; ++i) {
    const FaceFrame& frame = face_frame(static_cast<Face>(i));
    EXPECT_EQ(frame.name, names.at(i));
    EXPECT_EQ(frame.n, normals.at(i));
    EXPECT_EQ(glm::cross(frame.u, frame.v), frame.n);
  }
}

TEST(DirectionInterval, TiesGoToXThenY) {
  EXPECT_EQ(interval_of(Vec3(1, 1, 1), 0).face, Face::kPosX);
  EXPECT_EQ(interval_of(Vec3(-2, 2, 2), 0).face, Face::kNegX);
  EXPECT_EQ(interval_of(Vec3(0, -3, 3), 0).face, Face::kNegY);
  EXPECT_EQ(interval_of(Vec3(1, 0, -1.0000001), 0).face, Face::kNegZ);
}

TEST(DirectionInterval, IsHalfOpenAndTheLastIsClosed) {
  // +x: a runs along -z, b along +y.
  EXPECT_EQ(interval_of(Vec3(1, 0, 0), 1), (DirectionInterval{Face::kPosX, 1, 1, 1}));
  EXPECT_EQ(interval_of(Vec3(1, -1e-15, 0), 1), (DirectionInterval{Face::kPosX, 1, 1, 0}));
  EXPECT_EQ(interval_of(Vec3(1, 1, -1), 3), (DirectionInterval{Face::kPosX, 3, 7, 7}));
  EXPECT_EQ(interval_of(Vec3(1, -1, 1), 3), (DirectionInterval{Face::kPosX, 3, 0, 0}));
  EXPECT_EQ(interval_of(Vec3(1, std::tan(0.5 * kEighthTurn) * (1 + 1e-12), 0), 2).j, 3);
  EXPECT_EQ(interval_of(Vec3(1, std::tan(0.5 * kEighthTurn) * (1 - 1e-12), 0), 2).j, 2);
}

TEST(DirectionInterval, HoldsItsDirectionsOnEveryLevelAndNests) {
  const std::uint64_t seed = 31;
  SCOPED_TRACE(seed);
  Rng rng(seed);
  for (int k = 0; k < 20'000; ++k) {
    const Vec3 direction(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    const int level = static_cast<int>(rng.below(21));
    const DirectionInterval node = interval_of(direction, level);
    const FaceFrame& frame = face_frame(node.face);
    const double a = std::atan2(glm::dot(direction, frame.u), glm::dot(direction, frame.n));
    const double b = std::atan2(glm::dot(direction, frame.v), glm::dot(direction, frame.n));
    const auto [a0, a1, b0, b1] = node.angles_rad();
    EXPECT_TRUE(a0 <= a && (a < a1 || a1 == kEighthTurn) && b0 <= b && (b < b1 || b1 == kEighthTurn)) << a << " " << b;
    if (level > 0) {
      EXPECT_EQ(interval_of(direction, level - 1), node.parent());
    }
  }
}

TEST(DirectionInterval, BordersOfNeighboursAndParentsAreTheSameNumbers) {
  const DirectionInterval node{Face::kNegZ, 5, 13, 30};
  const auto child = node.child(3);
  EXPECT_EQ(child, (DirectionInterval{Face::kNegZ, 6, 27, 61}));
  EXPECT_EQ(child.parent(), node);
  EXPECT_EQ(child.angles_rad()[1], node.angles_rad()[1]);
  EXPECT_EQ(child.angles_rad()[3], node.angles_rad()[3]);
  EXPECT_EQ(node.child(0).angles_rad()[1], node.child(1).angles_rad()[0]);
  EXPECT_EQ((DirectionInterval{Face::kNegZ, 5, 14, 30}).angles_rad()[0], node.angles_rad()[1]);
}

TEST(DirectionInterval, AdjacentFacesShareTheirEdges) {
  // Each corner of the cube is a corner of three level-0 intervals.
  std::array<int, 8> counts{};
  for (int face = 0; face < kFaceCount; ++face)
    for (const Vec3& corner : DirectionInterval{static_cast<Face>(face), 0, 0, 0}.corner_directions()) {
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(corner[axis]), std::sqrt(1.0 / 3.0), 1e-12);
      ++counts.at((corner.x > 0 ? 1U : 0U) + (corner.y > 0 ? 2U : 0U) + (corner.z > 0 ? 4U : 0U));
    }
  for (const int count : counts) EXPECT_EQ(count, 3);
}

TEST(DirectionInterval, CornersRunCounterClockwise) {
  for (int face = 0; face < kFaceCount; ++face) {
    const DirectionInterval node{static_cast<Face>(face), 2, 1, 3};
    const auto corners = node.corner_directions();
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 turn = glm::cross(corners.at((i + 1) % 4) - corners.at(i), corners.at((i + 2) % 4) - corners.at((i + 1) % 4));
      EXPECT_GT(glm::dot(turn, face_frame(node.face).n), 0.0);
    }
    EXPECT_LT(sine_between(corners[0], direction_at(node.face, node.angles_rad()[0], node.angles_rad()[2])), 1e-15);
  }
}

TEST(DirectionInterval, LevelForWidth) {
  EXPECT_EQ(level_for_width(90.0), 0);
  EXPECT_EQ(level_for_width(360.0), 0);
  EXPECT_EQ(level_for_width(89.0), 1);
  EXPECT_EQ(level_for_width(11.25), 3);
  EXPECT_EQ(level_for_width(11.0), 4);
}

TEST(DirectionInterval, RefusesWhatItCannotAnswer) {
  EXPECT_THROW(static_cast<void>(interval_of(Vec3(0.0), 1)), Failure);
  EXPECT_THROW(static_cast<void>(interval_of(Vec3(std::nan("")), 1)), Failure);
  EXPECT_THROW(static_cast<void>(interval_of(Vec3(1.0), 21)), Failure);
  try {
    static_cast<void>(level_for_width(0.0));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
  }
}

}  // namespace
}  // namespace standin
