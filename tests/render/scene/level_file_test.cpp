// lods.glb: what is read back is what was written, over the scene's own vertices; what does not fit the scene is refused.

#include "render/scene/level_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "render/base/error.h"
#include "render/scene/load.h"
#include "render/scene/mesh_builder.h"
#include "tests/render/scene/glb_maker.h"
#include "tests/render/scene/level_meshes.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using nlohmann::json;

/// A glTF primitive of a mesh; without normals where flat ones are to be made, and with a vertex too many in front.
json primitive_of(test::GlbMaker& maker, const Mesh& mesh, bool with_normals = true) {
  std::vector<float> positions{9, 9, 9}, normals{0, 1, 0}, uvs{0, 0};
  std::vector<std::uint32_t> corners;
  for (const glm::vec3& p : mesh.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  for (const glm::vec3& n : mesh.normals) normals.insert(normals.end(), {n.x, n.y, n.z});
  for (const glm::vec2& uv : mesh.uvs) uvs.insert(uvs.end(), {uv.x, uv.y});
  for (const std::uint32_t v : mesh.indices) corners.push_back(v + 1);
  json attributes{{"POSITION", maker.floats(positions, "VEC3")}, {"TEXCOORD_0", maker.floats(uvs, "VEC2")}};
  if (with_normals) attributes["NORMAL"] = maker.floats(normals, "VEC3");
  return {{"attributes", attributes}, {"indices", maker.indices(corners)}};
}

struct Loaded {
  explicit Loaded(const test::GlbMaker& maker, std::uint64_t split_triangles = 0) {
    LoadOptions options;
    options.split_triangles = split_triangles;
    options.split_extent = 0.0;
    const test::TemporaryFolder folder;
    std::ofstream(folder.path() / "scene.glb", std::ios::binary) << maker.glb();
    scene = load_scene(folder.path() / "scene.glb", options);
    before = scene;
  }
  void make_levels() { (void)add_object_levels(scene, test::kLevelOptions, WorkBudget()); }
  /// The scene as loaded, with the levels that the file of this one's holds.
  [[nodiscard]] Scene read_back() const {
    Scene read = before;
    const LevelFile file = write_levels(scene);
    EXPECT_EQ(read_levels(stated_levels(scene), file.glb, read), file.buffer_bytes);
    return read;
  }
  Scene scene, before;
};

test::GlbMaker gltf(const std::vector<json>& primitives, test::GlbMaker maker) {
  maker.json["meshes"] =
      json::array({{{"name", "other"}, {"primitives", {primitives[0]}}}, {{"name", "mesh"}, {"primitives", primitives}}});
  maker.json["nodes"] = json::array({{{"name", "node"}, {"mesh", 1}}, {{"name", "again"}, {"mesh", 1}, {"translation", {4, 0, 0}}}});
  maker.json["scenes"][0]["nodes"] = {0, 1};
  return maker;
}

test::GlbMaker two_parts() {
  test::GlbMaker maker;
  const json first = primitive_of(maker, test::ball(16)), second = primitive_of(maker, test::ball(11), false);
  return gltf({first, second}, maker);
}

json json_of(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  return json::parse(glb.substr(20, length));
}

void expect_same_levels(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t id = 0; id < a.objects.size(); ++id) {
    ASSERT_EQ(a.objects[id].levels.size(), b.objects[id].levels.size());
    for (std::size_t k = 0; k < a.objects[id].levels.size(); ++k) {
      const ObjectLevel &x = a.objects[id].levels[k], &y = b.objects[id].levels[k];
      EXPECT_EQ(x.error_m, y.error_m);
      EXPECT_EQ(x.least_distance_m, y.least_distance_m);
      EXPECT_EQ(x.triangle_count, y.triangle_count);
      ASSERT_EQ(x.part_count, y.part_count);
      for (std::uint32_t p = 0; p < x.part_count; ++p) {
        const Part &u = a.parts[x.first_part + p], &v = b.parts[y.first_part + p];
        const Mesh &m = a.meshes[u.mesh], &n = b.meshes[v.mesh];
        EXPECT_EQ(u.material, v.material);
        EXPECT_TRUE(m.positions == n.positions && m.normals == n.normals && m.uvs == n.uvs && m.indices == n.indices) << id << " " << k;
      }
    }
  }
}

TEST(LevelFile, HoldsNothingButCornersOfTheScenesOwnVertices) {
  Loaded loaded(two_parts());
  loaded.make_levels();
  ASSERT_EQ(loaded.scene.objects.size(), 2U);
  ASSERT_GE(loaded.scene.objects[0].levels.size(), 2U);
  const LevelFile file = write_levels(loaded.scene);
  const json gltf = json_of(file.glb);
  EXPECT_FALSE(gltf.contains("materials") || gltf.contains("images"));
  EXPECT_EQ(gltf["nodes"].size(), loaded.scene.objects[0].levels.size()) << "instances share their levels";
  std::uint64_t corners = 0;
  for (const json& accessor : gltf["accessors"]) {
    const bool zeros = !accessor.contains("bufferView");
    EXPECT_EQ(zeros, accessor["type"] == "VEC3");
    if (!zeros) corners += accessor["count"].get<std::uint64_t>();
  }
  EXPECT_LE(file.buffer_bytes, 2 * corners + 3);
  for (const json& mesh : gltf["meshes"])
    for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(mesh["primitives"][p]["extras"], (json{{"scene_mesh", 1}, {"scene_primitive", p}}));
}

TEST(LevelFile, ReadsBackWhatWasWritten) {
  Loaded loaded(two_parts());
  loaded.make_levels();
  expect_same_levels(loaded.scene, loaded.read_back());
}

TEST(LevelFile, PiecesOfASplitObjectReferToTheWholePrimitive) {
  test::GlbMaker maker;
  const json primitive = primitive_of(maker, test::ball(24));
  Loaded loaded(gltf({primitive}, maker), 700);
  ASSERT_GT(loaded.scene.objects.size(), 4U);
  loaded.make_levels();
  ASSERT_FALSE(stated_levels(loaded.scene).empty());
  expect_same_levels(loaded.scene, loaded.read_back());
}

// Of a piece with a part that is not simplified a viewer must not draw all of the primitive that the piece is a part of.
TEST(LevelFile, APiecesUntouchedPartSaysWhichTrianglesItIs) {
  test::GlbMaker maker;
  MeshBuilder box;
  box.box({-1, -1, -1}, {1, 1, 1});
  const json ball = primitive_of(maker, test::ball(40)), plain = primitive_of(maker, box.finish("box"));
  Loaded loaded(gltf({ball, plain}, maker), 700);
  loaded.make_levels();
  const json file = json_of(write_levels(loaded.scene).glb);
  std::set<std::string> named;
  for (const StatedLevel& level : stated_levels(loaded.scene)) named.insert(level.gltf_node);
  std::map<std::size_t, std::vector<std::uint64_t>> triangles;  // of the box's primitive, by node
  for (const json& node : file["nodes"]) {
    ASSERT_TRUE(named.contains(node["name"]));
    for (const json& primitive : file["meshes"][node["mesh"].get<std::size_t>()]["primitives"]) {
      ASSERT_TRUE(primitive.contains("indices")) << node << " draws the whole primitive " << primitive["extras"];
      if (primitive["extras"]["scene_primitive"] != 1) continue;
      const std::uint64_t corners = file["accessors"][primitive["indices"].get<std::size_t>()]["count"];
      EXPECT_LT(corners, 36U) << "no piece has the whole box";
      triangles[node["mesh"].get<std::size_t>()].push_back(corners / 3);
    }
  }
  EXPECT_FALSE(triangles.empty());
  const Scene read = loaded.read_back();
  expect_same_levels(loaded.scene, read);
  double bytes = 0.0;
  std::set<std::uint32_t> counted;
  for (const Object& object : loaded.scene.objects)
    for (const ObjectLevel& level : object.levels)
      for (std::uint32_t p = level.first_part; p < level.first_part + level.part_count; ++p)
        if (counted.insert(loaded.scene.parts[p].mesh).second) bytes += level_bytes(loaded.scene, loaded.scene.parts[p]);
  EXPECT_NEAR(static_cast<double>(write_levels(loaded.scene).buffer_bytes), bytes, 4.0);
}

/// As another format has it: no meshes to refer to.
void forget_the_file(Loaded& loaded) {
  for (Scene* scene : {&loaded.scene, &loaded.before}) {
    for (Part& part : scene->parts) part.gltf_mesh = -1;
    scene->textures.push_back({"bark.png", 1, 1, {0, 0, 0, 255}});
    scene->materials[scene->parts[0].material].texture = 0;
    scene->materials[scene->parts[0].material].name = "bark";
  }
}

std::string refusal_of(const std::vector<StatedLevel>& levels, const std::string& bytes, Scene scene) {
  try {
    (void)read_levels(levels, bytes, scene);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken);
    return failure.what();
  }
  return "";
}

/// The GLB with another JSON.
std::string with_json(const std::string& glb, const json& other) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  std::string text = other.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::string rest = glb.substr(20 + length);
  return glb.substr(0, 8) + test::GlbMaker::word(20 + text.size() + rest.size()) + test::GlbMaker::word(text.size()) + "JSON" + text + rest;
}

TEST(LevelFile, ACoordinateThatIsNoNumberIsRefusedByItsPlace) {
  Loaded loaded(two_parts());
  forget_the_file(loaded);
  loaded.make_levels();
  const std::string glb = write_levels(loaded.scene).glb;
  const json file = json_of(glb);
  ASSERT_EQ(refusal_of(stated_levels(loaded.scene), glb, loaded.before), "");
  const json& attributes = file["meshes"][0]["primitives"][0]["attributes"];
  for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"})
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
      const std::size_t id = attributes[name];
      const json &accessor = file["accessors"][id], &view = file["bufferViews"][accessor["bufferView"].get<std::size_t>()];
      std::string broken = glb;
      std::memcpy(broken.data() + glb.find("BIN") + 4 + view["byteOffset"].get<std::size_t>() + accessor["byteOffset"].get<std::size_t>() +
                      2 * view["byteStride"].get<std::size_t>(),
                  &wrong, sizeof wrong);
      EXPECT_EQ(refusal_of(stated_levels(loaded.scene), broken, loaded.before),
                "lods.glb: accessors[" + std::to_string(id) + "]: element 2 is no finite number");
    }
}

// Whether vertices are the file's own is the scene's to say: a material in the primitive of a glTF scene changes nothing.
TEST(LevelFile, WhoseVerticesTheyAreDoesNotDependOnAMaterial) {
  Loaded loaded(two_parts());
  loaded.make_levels();
  const std::string glb = write_levels(loaded.scene).glb;
  json file = json_of(glb);
  for (json& mesh : file["meshes"])
    for (json& primitive : mesh["primitives"]) primitive["material"] = 0;
  Scene read = loaded.before;
  (void)read_levels(stated_levels(loaded.scene), with_json(glb, file), read);
  expect_same_levels(loaded.scene, read);
}

// No glTF: vertices of its own, materials by name.
TEST(LevelFile, OtherScenesGetVerticesOfTheirOwn) {
  Loaded loaded(two_parts());
  forget_the_file(loaded);
  loaded.make_levels();
  const json gltf = json_of(write_levels(loaded.scene).glb);
  EXPECT_EQ(gltf["materials"][0]["name"], "bark");
  EXPECT_EQ(gltf["materials"][0]["extras"]["scene_texture"], "bark.png");
  EXPECT_FALSE(gltf.contains("images"));
  expect_same_levels(loaded.scene, loaded.read_back());
}

TEST(LevelFile, LevelsOfTheSceneFileAreNamedNotCopied) {
  test::GlbMaker maker;
  json meshes = json::array(), nodes = json::array();
  for (const int n : {16, 8}) {
    meshes.push_back({{"primitives", {primitive_of(maker, test::ball(n))}}});
    nodes.push_back({{"name", "node"}, {"mesh", meshes.size() - 1}});
  }
  maker.json["meshes"] = meshes;
  maker.json["nodes"] = nodes;
  maker.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1};
  maker.json["extensionsUsed"] = {"MSFT_lod"};
  Loaded loaded(maker);
  loaded.make_levels();
  ASSERT_EQ(loaded.scene.objects[0].levels.size(), 1U);
  const LevelFile file = write_levels(loaded.scene);
  EXPECT_EQ(file.buffer_bytes, 0U);
  EXPECT_EQ(json_of(file.glb)["meshes"][0]["primitives"][0]["extras"], (json{{"scene_mesh", 1}, {"scene_primitive", 0}}));
  expect_same_levels(loaded.scene, loaded.read_back());
}

TEST(LevelFile, WhatDoesNotFitTheSceneIsRefused) {
  Loaded loaded(two_parts());
  loaded.make_levels();
  const std::string glb = write_levels(loaded.scene).glb;
  const std::vector<StatedLevel> stated = stated_levels(loaded.scene);
  const auto refusal = [&](const std::vector<StatedLevel>& levels, const std::string& bytes) {
    return refusal_of(levels, bytes, loaded.before);
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string bytes = glb;
    bytes.replace(bytes.find(from), from.size(), to);
    return bytes;
  };
  EXPECT_EQ(refusal(stated, glb), "");
  auto other = stated;
  other[0].gltf_node = "lod_77";
  EXPECT_THAT(refusal(other, glb), testing::HasSubstr("there is no node lod_77"));
  other = stated;
  other[0].object = 9;
  EXPECT_THAT(refusal(other, glb), testing::HasSubstr("object 9 is not in the scene"));
  other = stated;
  ++other[0].triangle_count;
  EXPECT_THAT(refusal(other, glb), testing::HasSubstr("triangles, stated are"));
  EXPECT_THAT(refusal(stated, replaced("\"scene_mesh\":1", "\"scene_mesh\":0")), testing::HasSubstr("is no form of object 0"));
  std::string outside = glb;
  outside[outside.size() - 8] = outside[outside.size() - 7] = '\x7f';  // corners come last
  EXPECT_THAT(refusal(stated, outside), testing::HasSubstr("is none of the scene's"));
}

}  // namespace
}  // namespace standin
