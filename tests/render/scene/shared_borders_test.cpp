// Open borders where something else goes on are found, wherever in the world and in whatever mesh space; and no crack opens there.

#include "render/scene/shared_borders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/render/scene/level_meshes.h"

namespace standin {
namespace {

using test::scene_of_placed;
using test::sheet;
using testing::ElementsAre;

std::vector<bool> shared(const Scene& scene) {
  return borders_shared(scene, 1, WorkBudget());
}

Mat4 at(double x, double y = 0.0, double z = 0.0) {
  return glm::translate(Mat4(1.0), Vec3(x, y, z));
}

TEST(SharedBorders, AreFoundBetweenObjects) {
  EXPECT_THAT(shared(scene_of_placed({sheet(0.0), sheet(1.0)}, {{0, at(0)}, {1, at(0)}})), ElementsAre(true, true));
  EXPECT_THAT(shared(scene_of_placed({sheet(0.0), sheet(1.0)}, {{0, at(0)}, {1, at(0, 0.01)}})), ElementsAre(false, false));
}

// Two meshes about their own origins, as a loader leaves tiles of terrain: nothing but the world tells that they meet.
TEST(SharedBorders, AreFoundInTheWorldNotInMeshSpace) {
  EXPECT_THAT(shared(scene_of_placed({sheet(0.0), sheet(0.0)}, {{0, at(5000.25)}, {1, at(5001.25)}})), ElementsAre(true, true));
  EXPECT_THAT(shared(scene_of_placed({sheet(0.0), sheet(0.0)}, {{0, at(5000.25)}, {1, at(5002.0)}})), ElementsAre(false, false));
}

TEST(SharedBorders, InstancesLaidEndToEndShareThem) {
  EXPECT_THAT(shared(scene_of_placed({sheet()}, {{0, at(0)}, {0, at(1)}})), ElementsAre(true));
  EXPECT_THAT(shared(scene_of_placed({sheet()}, {{0, at(0)}})), ElementsAre(false));
}

TEST(SharedBorders, WhatIsClosedHasNone) {
  Mesh pyramid;
  pyramid.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  pyramid.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
  update_derived(pyramid);
  EXPECT_THAT(shared(scene_of_placed({pyramid, pyramid}, {{0, at(0)}, {1, at(1)}})), ElementsAre(false, false));
}

// Mirrored and turned about, so that equal places are equal to the last bits only.
TEST(SharedBorders, AreFoundBetweenMirroredObjects) {
  const Mat4 mirrored = at(2.0) * glm::scale(Mat4(1.0), Vec3(-1.0, 1.0, 1.0));
  const Mat4 turned = glm::rotate(Mat4(1.0), 0.7, glm::normalize(Vec3(1.0, 2.0, 3.0)));
  EXPECT_THAT(shared(scene_of_placed({sheet(), sheet()}, {{0, turned * at(0)}, {1, turned * mirrored}})), ElementsAre(true, true));
}

// Whatever level of the one is shown beside whatever level of the other, no vertex of the seam is missing on either side.
TEST(SharedBorders, ObjectsThatMeetDoNotComeApart) {
  const auto levels_at_seam = [](double gap) {
    Scene scene = scene_of_placed({sheet(), sheet()}, {{0, at(100.0)}, {1, at(101.0, gap)}});
    add_object_levels(scene, test::kLevelOptions, WorkBudget());
    std::set<std::size_t> vertices;
    for (const Object& object : scene.objects)
      for (const ObjectLevel& level : object.levels)
        vertices.insert(
            test::vertices_at(scene.meshes[scene.parts[level.first_part].mesh], &object == &scene.objects[0] ? 1.0F : 0.0F).size());
    return vertices;
  };
  EXPECT_THAT(levels_at_seam(0.0), ElementsAre(21U));
  EXPECT_LT(*levels_at_seam(0.5).begin(), 21U) << "without a neighbour the border is free";
}

}  // namespace
}  // namespace standin
