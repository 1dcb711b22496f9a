#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/view_space.h"
#include "render/base/error.h"
#include "tests/support/ascii_world.h"

namespace standin {
namespace {

Scene one_cube(double half_m, const Vec3& centre) {
  Scene scene;
  test::add_material(scene, {});
  test::add_object(scene, test::add_mesh(scene, test::make_cube()), 0, test::world_from_unit({centre, centre + half_m}));
  update_derived(scene);
  return scene;
}

TEST(Orbit, BoxesAreTheCubesThatMeetTheShell) {
  const Scene scene = one_cube(3.0, {100, 20, -5});
  const double radius = 3.0 * std::sqrt(3.0);
  const ViewSpace space = make_orbit_view_space(scene, {});
  const Vec3 centre(100, 20, -5);
  const double leaf = std::ldexp(space.root_side_m, -space.leaf_level);
  EXPECT_DOUBLE_EQ(leaf, radius);  // leaves of 23 m would hold the whole scene
  EXPECT_TRUE(space.left_out.empty());
  for (const Box& box : space.boxes) {
    EXPECT_LE(distance(centre, box), 10.0 * radius * 1.000001);
    const Vec3 far_corner = glm::max(glm::abs(box.min - centre), glm::abs(box.max - centre));
    EXPECT_GE(glm::length(far_corner), 2.5 * radius);
    EXPECT_GE(distance(centre, box), (2.5 - 0.25 * std::sqrt(3.0)) * radius);  // no more than the diagonal of a quarter leaf inside
  }
  const CellBoxes cells(space);
  for (const CellKey& key : cells.leaves()) EXPECT_GT(distance(scene.bounds, cells.cell_box(key)), 0.0);
}

TEST(Orbit, EveryPointOfTheShellIsInABox) {
  const Scene scene = one_cube(1.0, {0, 0, 0});
  const ViewSpace space = make_orbit_view_space(scene, {});
  Rng rng(7);
  for (int i = 0; i < 500; ++i) {
    Vec3 direction(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (i < 3) direction = Vec3(i == 0, i == 1, i == 2);
    const Vec3 position = glm::normalize(direction) * rng.uniform(2.5, 10.0) * std::sqrt(3.0);
    EXPECT_TRUE(std::any_of(space.boxes.begin(), space.boxes.end(), [&](const Box& box) { return box.contains(position); }));
  }
}

double leaf_side_of(const ViewSpace& space) {
  return std::ldexp(space.root_side_m, -space.leaf_level);
}

TEST(Orbit, LeavesGrowBeyondTheLimitAndThatIsSaid) {
  ViewSpaceOptions options;
  options.leaf_m = 0.5;
  const ViewSpace space = make_orbit_view_space(one_cube(1.0, {0, 0, 0}), options);
  EXPECT_LE(CellBoxes(space).leaves().size(), 20'000U);
  EXPECT_THAT(space.left_out, testing::ElementsAre(testing::HasSubstr("instead of 0.5 m: more than 20000 otherwise")));
}

TEST(Orbit, NoLimitMakesLeavesReachIntoTheScene) {
  for (const double leaf_m : {0.5, 23.0}) {
    ViewSpaceOptions options;
    options.leaf_m = leaf_m;
    options.max_leaves = 100;
    const Scene scene = one_cube(1.0, {0, 0, 0});
    const ViewSpace space = make_orbit_view_space(scene, options);
    EXPECT_DOUBLE_EQ(leaf_side_of(space), std::sqrt(3.0));
    const CellBoxes cells(space);
    EXPECT_GT(cells.leaves().size(), 100U);
    for (const CellKey& key : cells.leaves()) EXPECT_GT(distance(scene.bounds, cells.cell_box(key)), 0.5 * std::sqrt(3.0));
    EXPECT_THAT(space.left_out.back(), testing::HasSubstr("would reach into the scene"));
  }
}

TEST(Orbit, AnEmptySceneOrShellIsRefused) {
  ViewSpaceOptions inside_out;
  inside_out.orbit_near = 10.0;
  inside_out.orbit_far = 2.0;
  try {
    (void)make_orbit_view_space(one_cube(0.0, {0, 0, 0}), {});
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kViewSpaceEmpty);
  }
  try {
    (void)make_orbit_view_space(one_cube(1.0, {0, 0, 0}), inside_out);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
  }
}

}  // namespace
}  // namespace standin
