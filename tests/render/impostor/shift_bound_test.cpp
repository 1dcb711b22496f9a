// The shift of a point against its texel: by hand, and never below what any viewpoint sees.
#include "render/impostor/shift_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/rng.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "tests/render/impostor/ray_judge.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

ImpostorFrame frame_of_texel(double step) {
  ImpostorFrame frame;
  frame.slope_step = Vec2(step);
  return frame;
}

// A viewpoint 1 m beside the reference viewpoint sees a point 12 m away against a plane at 10 m: 1 (1/10 - 1/12) = 1/60 of slope.
TEST(ShiftBound, OfAFlatCellIsTheCornersShift) {
  const LayerSetup setup{.kind = LayerSetup::Kind::kBox, .near_border = Vec2(2.0, 4.0), .object_width = Vec2(0.0), .t0 = 8.0};
  const Vec2 shift = ShiftBound(setup, frame_of_texel(0.01)).texels(12.0, 10.0);
  EXPECT_NEAR(shift.x, 100.0 / 60.0, 1e-12);
  EXPECT_NEAR(shift.y, 200.0 / 60.0, 1e-12);
  EXPECT_EQ(ShiftBound(setup, frame_of_texel(0.01)).texels(10.0, 10.0), Vec2(0.0));
}

TEST(ShiftBound, IsNeverBelowAnyViewpoints) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Rng rng(seed);
    const bool shaft = seed % 2 == 0;
    LayerSetup setup{.kind = shaft ? LayerSetup::Kind::kShaft : LayerSetup::Kind::kBox};
    setup.near_border = Vec2(rng.uniform(0.0, 4.0), rng.uniform(0.0, 4.0));
    setup.s = rng.uniform(0.0, 2.0);
    setup.cell_depth = setup.s + rng.uniform(0.0, 10.0);
    if (shaft) setup.tan_half = Vec2(rng.uniform(0.0, 1.0), rng.uniform(0.0, 1.0));
    setup.t0 = rng.uniform(0.5, 30.0);
    const Vec2 slope(rng.uniform(0.0, 0.6), rng.uniform(0.0, 0.6));
    setup.object_width = 2.0 * (setup.t0 + setup.s) * slope;
    const double d = setup.s + setup.t0 * (1.0 + rng.uniform()), layer = setup.s + setup.t0 * (1.0 + rng.uniform());
    const Vec2 bound = ShiftBound(setup, frame_of_texel(0.01)).texels(d, layer);
    for (int k = 0; k < 200; ++k) {
      const double q = shaft ? std::pow(10.0, rng.uniform(-2.0, 3.0)) : rng.uniform(0.0, setup.cell_depth), height = setup.s - q;
      for (int axis = 0; axis < 2; ++axis) {
        const double beside = rng.uniform(-1.0, 1.0) * (0.5 * setup.near_border[axis] + setup.tan_half[axis] * q);
        const double u = rng.uniform(-1.0, 1.0) * slope[axis];
        const double kappa = u * height - beside;
        const double shift = std::abs(kappa * (1.0 / (layer - height) - 1.0 / (d - height))) / 0.01;
        ASSERT_LE(shift, bound[axis] * (1.0 + 1e-12) + 1e-12) << "seed " << seed;
      }
    }
  }
}

/// Two walls at different depths, one of which ends where, seen from a corner of the view cell, the other begins.
std::vector<test::WorldTriangle> walls_that_meet(Rng& rng, const Vec3& eye) {
  const double front_z = rng.uniform(-2.0, 0.0), back_z = rng.uniform(-6.0, -3.0), front_x = rng.uniform(-1.0, 1.0);
  const double back_x = eye.x + (front_x - eye.x) * (back_z - eye.z) / (front_z - eye.z);
  std::vector<test::WorldTriangle> walls = test::rectangle({front_x - 2.0, -1.0, front_z}, {2.0, 0.0, 0.0}, {0.0, 2.0, 0.0});
  const auto back = test::rectangle({back_x - 0.001, -1.5, back_z}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
  walls.insert(walls.end(), back.begin(), back.end());
  return walls;
}

// Surfaces that are not connected: nothing but their own texels keeps what lies behind from showing through where they meet.
TEST(ShiftBound, SealedRimsLeaveNoGapBetweenWallsThatMeetInAView) {
  const Box cell{Vec3(-1.5, -0.2, 9.0), Vec3(1.5, 0.2, 11.0)};
  Camera camera;
  camera.width = camera.height = 256;
  std::array<test::Verdict, 2> verdicts;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Rng rng(seed);
    const Vec3 eye(seed % 2 == 0 ? cell.min.x : cell.max.x, rng.uniform(-0.2, 0.2), 9.0);
    const auto walls = walls_that_meet(rng, eye);
    test::SmallScene scene;
    scene.add_object(walls);
    const Vec3 meeting = walls.back()[0];
    for (const bool sealed : {false, true}) {
      const Impostor impostor = bake_layered(scene.scene, {{0}, cell}, camera, {.seal_rims = sealed});
      const test::DrawnImpostor drawn(impostor);
      Rng rays(seed, 1);
      for (int ray = 0; ray < 40; ++ray) {
        const Vec3 target = Vec3(meeting.x, 0.0, meeting.z) + Vec3(rays.uniform(-0.3, 0.3), rays.uniform(-0.5, 0.5), 0.0);
        test::judge_pixel(test::opaque_surfaces(walls), impostor, drawn, eye, target - eye, camera.pixel_angle_rad(),
                          verdicts.at(sealed ? 1 : 0));
      }
    }
  }
  std::printf("%d of %d pixels are gaps unless rims are sealed\n", verdicts[0].gaps, verdicts[0].judged);
  EXPECT_GT(verdicts[1].judged, 500);
  EXPECT_GT(verdicts[0].gaps, 0) << "the check can fail";
  EXPECT_EQ(verdicts[1].gaps, 0);
}

// A wall against nothing: the texels beyond its rims would only fatten it.
TEST(OuterRims, OfASurfaceAgainstNothingStayAsTheyAre) {
  test::SmallScene scene;
  scene.add_object(test::rectangle({-1, -1, 0}, {2.013, 0, 0}, {0, 2.017, 0}));
  const Box cell{Vec3(-1.5, -0.2, 9.0), Vec3(1.5, 0.2, 11.0)};
  const auto texels = [&](bool sealed) {
    const Impostor impostor = bake_layered(scene.scene, {{0}, cell}, Camera(), {.seal_rims = sealed});
    std::size_t opaque = 0;
    for (std::size_t i = 3; i < impostor.texels.size(); i += 4) opaque += impostor.texels[i] != 0 ? 1 : 0;
    return opaque;
  };
  EXPECT_GT(texels(false), 1000U);
  EXPECT_EQ(texels(true), texels(false));
}

}  // namespace
}  // namespace standin
