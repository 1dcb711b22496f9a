// placement.json keeps every value, and a broken one is refused by place and reason.
#include "server/files/placement_json.h"

#include <gtest/gtest.h>

#include "render/base/error.h"

namespace standin {
namespace {

using nlohmann::json;

Scene two_object_scene() {
  Scene scene;
  scene.name = "two.glb";
  for (int i = 0; i < 2; ++i) {
    Object object;
    object.name = "object " + std::to_string(i);
    object.bounds = Box{Vec3(i), Vec3(i + 0.5)};
    scene.objects.push_back(object);
  }
  return scene;
}

PlacementFile sample_file() {
  PlacementFile file;
  file.spec.budget_ms = 12.5;
  file.scene_name = "two.glb";
  file.scene_sha256 = "ab";
  file.target_id = "a machine";
  file.target_sha256 = "cd";
  file.coverage = 0.99;
  file.view_space.kind = ViewSpaceKind::kWalk;
  file.view_space.why = "because";
  file.view_space.boxes = {Box{{0, 1.6, 0}, {8, 1.8, 8}}};
  file.view_space.root_side_m = 16.0;
  file.view_space.leaf_level = 1;
  file.view_space.finest_level = 2;
  file.atlas_pages = 1;
  Placement& placement = file.placement;
  placement.root_side_m = 16.0;
  placement.cells = {{{1, {0, 0, 0}}, Box{{0, 1.6, 0}, {8, 1.8, 8}}, 0}, {{1, {1, 0, 0}}, Box{{8, 1.6, 0}, {8, 1.8, 8}}, -1}};
  placement.visible_sets = {{0, 1}};
  placement.intervals = {{Face::kNegX, 3, 1, 2}};
  placement.cpvs = {{0, 0, 20.0, 11.0, true, {0}}};
  Shaft shaft = shaft_frame({0.1, 0.2, 0.3}, {1, 0, 0});
  shaft.tan_half = {0.25, 1.0 / 3.0};
  shaft.min_distance_m = 7.0;
  PlacementImpostor impostor;
  impostor.objects = {1};
  impostor.view_cell = shaft;
  impostor.frame.width = 4;
  impostor.frame.height = 5;
  impostor.frame.slope_step = {0.01, 0.02};
  impostor.layers = {{10.0, 9.0, 11.0}};
  impostor.quads = 3;
  impostor.texels = 20;
  impostor.texture_bytes = 168;
  impostor.geometry_bytes = 264;
  impostor.time_bound_ms = 0.1;
  placement.impostors = {impostor};
  return file;
}

TEST(PlacementJson, RoundTripKeepsEveryValue) {
  const Scene scene = two_object_scene();
  const json written = placement_to_json(sample_file(), scene);
  const PlacementFile read = placement_from_json(json::parse(written.dump()), "p");
  EXPECT_EQ(placement_to_json(read, scene), written);
  EXPECT_EQ(read.placement.cells[1].visible_set, -1);
  EXPECT_EQ(read.placement.visible_sets.size(), 1U);
}

TEST(PlacementJson, LevelsOfDetailAreStatedByObject) {
  Scene scene = two_object_scene();
  for (int k = 0; k < 16; ++k) scene.objects[1].world_from_object[k / 4][k % 4] = 1.0 / (k + 3.0);
  scene.objects[1].levels = {{4, 1, 70, 0.125, -1.0, 12.5}, {5, 1, 9, -1.0, 0.1, 1.0 / 3.0 + 20.0}};
  PlacementFile file = sample_file();
  file.lods_sha256 = "ef";
  const json written = placement_to_json(file, scene);
  EXPECT_EQ(written["lods"]["objects"].size(), 1U);
  EXPECT_EQ(written["lods"]["objects"][0]["levels"][0]["gltf_node"], "lod_0");
  EXPECT_EQ(written["lods"]["objects"][0]["levels"][0]["error"], 0.125);
  EXPECT_TRUE(written["lods"]["objects"][0]["levels"][1]["error"].is_null());
  const PlacementFile read = placement_from_json(json::parse(written.dump()), "p");
  EXPECT_EQ(placement_to_json(read, scene), written);
  ASSERT_EQ(read.placement.levels.size(), 1U);
  EXPECT_EQ(read.placement.levels[0].object, 1U);
  EXPECT_EQ(read.placement.levels[0].bounds, scene.objects[1].bounds);
  EXPECT_EQ(written["lods"]["objects"][0]["world_from_object"][13], 1.0 / 16.0) << "column major: the second of the last column";
  EXPECT_EQ(read.placement.levels[0].world_from_object, scene.objects[1].world_from_object);
  EXPECT_EQ(read.placement.levels[0].least_distance_m, (std::vector<double>{12.5, 1.0 / 3.0 + 20.0}));
  for (const auto& [pointer, value] : std::vector<std::pair<std::string, json>>{{"/lods/objects/0/object", 2},
                                                                                {"/lods/objects/0/levels/1/least_distance", 3.0},
                                                                                {"/lods/objects/0/world_from_object", {1, 0, 0}},
                                                                                {"/lods/asset/sha256", 3}}) {
    json bad = written;
    bad[json::json_pointer(pointer)] = value;
    EXPECT_THROW((void)placement_from_json(bad, "p"), Failure) << pointer;
  }
}

TEST(PlacementJson, PositionsOfTheViewSpaceReadCanBeSampled) {
  const PlacementFile read = placement_from_json(placement_to_json(sample_file(), two_object_scene()), "p");
  Rng rng(1);
  const Vec3 position = read.view_space.sample_position(rng);
  const Box& box = read.view_space.boxes[0];
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(position[axis], box.min[axis]);
    EXPECT_LE(position[axis], box.max[axis]);
  }
}

TEST(PlacementJson, WritesTheContractsNames) {
  const json object = placement_to_json(sample_file(), two_object_scene());
  EXPECT_EQ(object["format"], "standin.placement");
  EXPECT_EQ(object["faces"]["+x"]["n"], json({1.0, 0.0, 0.0}));
  EXPECT_EQ(object["impostors"][0]["view_cell"]["frame"].size(), 9U);
  EXPECT_EQ(object["impostors"][0]["gltf_node"], "imp_0");
  EXPECT_TRUE(object["cells"][1]["visible_objects"].is_null());
  EXPECT_FALSE(object["spec"].contains("threads"));
}

void expect_refused(const json& object, const std::string& what) {
  try {
    (void)placement_from_json(object, "p.json");
    ADD_FAILURE() << "accepted a file with a broken " << what;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
    EXPECT_NE(std::string(failure.what()).find("p.json"), std::string::npos);
  }
}

TEST(PlacementJson, BrokenFilesAreRefused) {
  const json good = placement_to_json(sample_file(), two_object_scene());
  for (const auto& [pointer, value] : std::vector<std::pair<std::string, json>>{{"/version", 2},
                                                                                {"/cpvs/0/cell", 9},
                                                                                {"/cpvs/0/impostors/0", 1},
                                                                                {"/impostors/0/objects/0", 2},
                                                                                {"/cells/0/visible_objects/1", 2},
                                                                                {"/intervals/0/face", "up"},
                                                                                {"/view_space/kind", "swim"},
                                                                                {"/cells", 3},
                                                                                {"/cells/0/level", 1e18},
                                                                                {"/cells/0/index/2", -1e18},
                                                                                {"/cells/0/visible_objects/0", 0.5},
                                                                                {"/cells/0/visible_objects", "x"},
                                                                                {"/intervals/0/level", 1.5},
                                                                                {"/cpvs/0/cell", -1},
                                                                                {"/cpvs/0/interval", 4294967296U},
                                                                                {"/impostors/0/quads", 1e300},
                                                                                {"/impostors/0/texture_bytes", 1e17},
                                                                                {"/camera/width", 1e10},
                                                                                {"/view_space/root/leaf_level", 1e10},
                                                                                {"/impostors/0/layers/0/near", "x"}}) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    expect_refused(bad, pointer);
  }
  expect_refused(json::object(), "everything");
}

}  // namespace
}  // namespace standin
