#include <gtest/gtest.h>

#include <cmath>

#include "estimation/features.h"
#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

const Camera kCamera;

/// Two layers of 64 x 64 texels at 10 and 14 m in front of a reference viewpoint at the origin, looking along -z.
Impostor two_layers(const ViewCell& cell) {
  Impostor impostor;
  impostor.view_cell = cell;
  impostor.frame.slope_min = Vec2(-0.08, 0.08);
  impostor.frame.slope_step = Vec2(0.0025);
  impostor.frame.width = impostor.frame.height = 64;
  impostor.layers = {{10.0, 9.0, 12.0}, {14.0, 12.0, 16.0}};
  impostor.quads = {{0, 0, 0, 64, 64}, {1, 8, 8, 32, 16}};
  impostor.texels.resize(4 * (64 * 64 + 32 * 16));
  return impostor;
}

Shaft shaft_to_origin() {
  Shaft shaft = shaft_frame(Vec3(0.0, 0.0, -12.0), Vec3(0.0, 0.0, 1.0));
  shaft.tan_half = Vec2(0.2);
  shaft.min_distance_m = 11.0;  // border at z = -1: 9 m before the first layer
  return shaft;
}

TEST(ImpostorCost, TakesTheGreatestTexelAngleFromTheNearBorder) {
  const Impostor impostor = two_layers(shaft_to_origin());
  const ImpostorCost cost = impostor_cost(impostor);
  EXPECT_EQ(cost.quads, 2.0);
  EXPECT_EQ(cost.texels, 64.0 * 64.0 + 32.0 * 16.0);
  EXPECT_DOUBLE_EQ(cost.texel_angle_rad, 0.0025 * 10.0 / 9.0);
  EXPECT_DOUBLE_EQ(impostor_cost(two_layers(Box{Vec3(-1, -1, -2), Vec3(1, 1, 0)})).texel_angle_rad, 0.0025 * 10.0 / 8.0);
}

TEST(ImpostorCost, RefusesALayerInsideItsViewCell) {
  EXPECT_THROW((void)impostor_cost(two_layers(Box{Vec3(-1, -1, -10), Vec3(1, 1, 0)})), Failure);
}

TEST(ImpostorFeatures, OfASquareSeenFromTheReferenceViewpoint) {
  Impostor impostor = two_layers(shaft_to_origin());
  impostor.quads.pop_back();
  const Box bounds{Vec3(-1, -1, -14), Vec3(1, 1, -9)};
  const Features features = impostor_features(impostor, bounds, {Vec3(0.0), Vec3(0.0, 0.0, -1.0)}, kCamera);
  const double expected = std::pow(0.16 * kCamera.focal_px(), 2);
  EXPECT_NEAR(features[Term::kImpostorPixels], expected, 0.01 * expected);
  EXPECT_EQ(features[Term::kDraws], 1.0);
  EXPECT_EQ(features[Term::kImpostorQuads], 1.0);
  EXPECT_EQ(features[Term::kTriangles], 0.0);
  EXPECT_EQ(features[Term::kTextureSwitches], 0.0);
  const Features behind = impostor_features(impostor, bounds, {Vec3(0.0), Vec3(0.0, 0.0, 1.0)}, kCamera);
  for (const double value : behind.value) EXPECT_EQ(value, 0.0);
}

TEST(ImpostorFeatures, AreWithinTheBoundFromAnywhereInTheViewCell) {
  const Impostor impostor = two_layers(shaft_to_origin());
  const Shaft& shaft = std::get<Shaft>(impostor.view_cell);
  const Features bound = impostor_features_bound(impostor_cost(impostor), kCamera);
  const Box bounds{Vec3(-1.2, -1.2, -16), Vec3(1.2, 1.2, -9)};
  int seen = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    Rng rng(17, i);
    const double along_m = 11.0 + rng.uniform() * rng.uniform() * 30.0;
    const Vec3 eye = shaft.apex + along_m * Vec3(rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), 1.0);
    const Vec3 target(rng.uniform(-2, 2), rng.uniform(-2, 2), -11.0);
    const Features features = impostor_features(impostor, bounds, {eye, glm::normalize(target - eye)}, kCamera);
    seen += features[Term::kImpostorPixels] > 0.0 ? 1 : 0;
    for (std::size_t t = 0; t < kTermCount; ++t)
      ASSERT_LE(features.value[t], bound.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << i;
  }
  EXPECT_GT(seen, 2000);
}

TEST(ImpostorFeatures, OfAnImpostorWithoutQuadsAreZero) {
  Impostor impostor = two_layers(shaft_to_origin());
  impostor.quads.clear();
  impostor.texels.clear();
  for (const double value : impostor_features_bound(impostor_cost(impostor), kCamera).value) EXPECT_EQ(value, 0.0);
}

}  // namespace
}  // namespace standin
