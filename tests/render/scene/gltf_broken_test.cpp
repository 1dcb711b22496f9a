// Hostile and damaged glTF: each guard must be the one that fires.

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>
#include <limits>

#include "render/base/rng.h"
#include "render/image/image_io.h"
#include "tests/render/scene/glb_maker.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using test::GlbMaker;
using test::load_failure;
using test::noted;
using test::square_glb;
using test::TemporaryFolder;
using Kind = LoadNote::Kind;

ErrorWord failure_of(const GlbMaker& maker, const std::string& part, const LoadOptions& options = {}) {
  const TemporaryFolder folder;
  return load_failure(folder.write("scene.glb", maker.glb()), part, options);
}

void show_image(GlbMaker& maker, const std::string& bytes) {
  maker.json["images"] = GlbMaker::Json::array({{{"bufferView", maker.view(bytes.data(), bytes.size())}}});
  maker.json["textures"] = GlbMaker::Json::array({{{"source", 0}}});
  maker.json["materials"] = GlbMaker::Json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  maker.primitive()["material"] = 0;
}

TEST(GltfBroken, MissingFile) {
  EXPECT_EQ(load_failure("/nowhere/scene.glb", "/nowhere/scene.glb"), ErrorWord::kFileMissing);
}

// Every prefix of a good file is a broken file, never a crash or half a scene.
TEST(GltfBroken, TruncatedAnywhere) {
  const TemporaryFolder folder;
  const std::string whole = square_glb().glb();
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    EXPECT_EQ(load_failure(folder.write("cut.glb", whole.substr(0, size))), ErrorWord::kFileBroken) << size;
  }
}

// Whatever byte changes, loading gives a scene or a Failure.
TEST(GltfBroken, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  const std::string whole = square_glb().glb();
  Rng rng(7);
  int loaded = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string damaged = whole;
    for (int flip = 0; flip < 3; ++flip) damaged[rng.below(damaged.size())] = static_cast<char>(rng.below(256));
    try {
      const Scene scene = load_scene(folder.write("flipped.glb", damaged));
      ++loaded;
      for (const Mesh& mesh : scene.meshes) {
        for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size());
        for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      }
    } catch (const Failure&) {
    }
  }
  EXPECT_GT(loaded, 0);
  EXPECT_LT(loaded, 400);
}

TEST(GltfBroken, HugeCountIsRefusedBeforeItIsRead) {
  GlbMaker maker = square_glb();
  maker.json["accessors"][0]["count"] = 4'000'000'000U;
  EXPECT_EQ(failure_of(maker, "do not fit"), ErrorWord::kFileBroken);
  maker.json["accessors"][0].erase("bufferView");
  EXPECT_EQ(failure_of(maker, "no bytes"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, RangesThatWrapAround) {
  GlbMaker maker = square_glb();
  maker.json["accessors"][0]["byteOffset"] = std::numeric_limits<std::uint64_t>::max() - 3;
  EXPECT_EQ(failure_of(maker, "do not fit"), ErrorWord::kFileBroken);
  maker = square_glb();
  maker.json["bufferViews"][0]["byteOffset"] = 8;
  maker.json["bufferViews"][0]["byteLength"] = std::numeric_limits<std::uint64_t>::max() - 7;
  EXPECT_EQ(failure_of(maker, "covers bytes"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, NumbersThatAreNone) {
  GlbMaker maker = square_glb();
  for (const auto& wrong : {GlbMaker::Json(-1), GlbMaker::Json(1.5), GlbMaker::Json("4"), GlbMaker::Json(1e300)}) {
    maker.json["accessors"][0]["count"] = wrong;
    EXPECT_EQ(failure_of(maker, "not a whole number"), ErrorWord::kFileBroken) << wrong;
  }
  maker = square_glb();
  maker.json["nodes"][0]["matrix"] = {1, 2, 3};
  EXPECT_EQ(failure_of(maker, "list of 16 numbers"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, ReferencesToNothing) {
  GlbMaker maker = square_glb();
  maker.json["nodes"][0]["mesh"] = 5;
  EXPECT_EQ(failure_of(maker, "meshes[5]"), ErrorWord::kFileBroken);
  maker = square_glb();
  maker.primitive()["material"] = 2;
  EXPECT_EQ(failure_of(maker, "materials[2]"), ErrorWord::kFileBroken);
  maker = square_glb();
  maker.json["bufferViews"][0]["buffer"] = 3;
  EXPECT_EQ(failure_of(maker, "buffers[3]"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, NodeCycle) {
  GlbMaker maker = square_glb();
  maker.json["nodes"][0]["children"] = {0};
  EXPECT_EQ(failure_of(maker, "twice"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, JsonNestedTooDeep) {
  const TemporaryFolder folder;
  const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[') + std::string(100000, ']') + "}";
  EXPECT_EQ(load_failure(folder.write("deep.gltf", deep), "nested deeper"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, OldVersion) {
  GlbMaker maker = square_glb();
  maker.json["asset"]["version"] = "1.0";
  EXPECT_EQ(failure_of(maker, "'1.0'"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, RequiredExtensionsAreRefusedByName) {
  GlbMaker maker = square_glb();
  maker.json["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_draco_mesh_compression"};
  EXPECT_EQ(failure_of(maker, "KHR_draco_mesh_compression"), ErrorWord::kExtensionUnknown);
}

TEST(GltfBroken, UrisStayInTheFolder) {
  for (const std::string uri : {"/etc/passwd", "../secret.bin", "a/../../secret.bin", "%2e%2e/secret.bin", "..%5Csecret.bin",
                                "http://example.org/x.bin", "file:///etc/passwd", "C:\\secret.bin"}) {
    GlbMaker maker = square_glb();
    maker.json["images"] = GlbMaker::Json::array({{{"uri", uri}}});
    EXPECT_EQ(failure_of(maker, "'"), ErrorWord::kUriForbidden) << uri;
    maker = square_glb();
    maker.json["buffers"] = GlbMaker::Json::array({{{"uri", uri}, {"byteLength", 4}}});
    EXPECT_EQ(failure_of(maker, "'"), ErrorWord::kUriForbidden) << uri;
  }
}

TEST(GltfBroken, ANameTooLongForAnyFileIsRefused) {
  for (const std::size_t length : {300U, 10'000U}) {
    GlbMaker maker = square_glb();
    maker.json["images"] = GlbMaker::Json::array({{{"uri", std::string(length, 'n') + ".png"}}});
    EXPECT_EQ(failure_of(maker, "names no file"), ErrorWord::kUriForbidden) << length;
  }
}

TEST(GltfBroken, LinksMayNotLeadOut) {
  const TemporaryFolder folder;
  GlbMaker maker = square_glb();
  maker.json["images"] = GlbMaker::Json::array({{{"uri", "link/hostname"}}});
  const auto file = folder.write("scene.glb", maker.glb());
  std::filesystem::create_directory_symlink("/etc", folder.path() / "link");
  EXPECT_EQ(load_failure(file, "leads out"), ErrorWord::kUriForbidden);
}

TEST(GltfBroken, MissingBufferFile) {
  GlbMaker maker = square_glb();
  maker.json["buffers"] = GlbMaker::Json::array({{{"uri", "gone.bin"}, {"byteLength", 4}}});
  EXPECT_EQ(failure_of(maker, "gone.bin"), ErrorWord::kFileMissing);
}

TEST(GltfBroken, BadTrianglesAreDroppedAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  GlbMaker maker;
  maker.show({0, 0, 0, 1, 0, 0, 1, 1, 0, nan, 0, 0, 0, inf, 0, 2, 0, 0},
             {0, 1, 2, /**/ 0, 1, 3, /**/ 0, 4, 2, /**/ 0, 1, 99, /**/ 0, 1, 5, /**/ 1, 1, 2, /**/ 0, 1});
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write("scene.glb", maker.glb()));
  EXPECT_EQ(scene.triangle_count(), 1U);
  EXPECT_EQ(scene.meshes[0].positions.size(), 3U);
  EXPECT_EQ(noted(scene, Kind::kDropped, "triangles", "not finite"), 2U);
  EXPECT_EQ(noted(scene, Kind::kDropped, "triangles", "out of range"), 1U);
  EXPECT_EQ(noted(scene, Kind::kDropped, "triangles", "no area"), 2U);
  EXPECT_EQ(noted(scene, Kind::kDropped, "indices"), 2U);
}

TEST(GltfBroken, NothingLeftIsRefusedWithTheReason) {
  GlbMaker maker;
  maker.show({0, 0, 0, 1, 0, 0, 2, 0, 0}, {0, 1, 2});
  EXPECT_EQ(failure_of(maker, "no area"), ErrorWord::kSceneEmpty);
  maker = square_glb();
  maker.primitive()["mode"] = 0;
  EXPECT_EQ(failure_of(maker, "points and lines"), ErrorWord::kSceneEmpty);
  maker = square_glb();
  maker.json["nodes"][0]["scale"] = {0, 0, 0};
  EXPECT_EQ(failure_of(maker, "flattens"), ErrorWord::kSceneEmpty);
}

TEST(GltfBroken, WhatIsDroppedDoesNotStretchTheScene) {
  GlbMaker maker = square_glb();
  maker.json["nodes"].push_back({{"mesh", 0}, {"scale", {1e200, 1e200, 1}}});
  maker.json["scenes"][0]["nodes"] = {0, 1};
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write("scene.glb", maker.glb()));
  EXPECT_EQ(noted(scene, Kind::kDropped, "objects"), 1U);
  EXPECT_EQ(scene.bounds.max, Vec3(1.0, 1.0, 0.0));
}

// A square that faces z and one that faces x, which the node flattens.
TEST(GltfBroken, PiecesThatAreFlattenedToNothingAreDropped) {
  GlbMaker maker;
  maker.show({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 9, 0, 0, 9, 0, 1, 9, 1, 1, 9, 1, 0}, {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7});
  maker.json["nodes"][0]["scale"] = {1, 1, 0};
  LoadOptions options;
  options.split_triangles = 2;
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write("scene.glb", maker.glb()), options);
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].area_m2, 1.0);
  EXPECT_EQ(scene.meshes.size(), 1U);
}

TEST(GltfBroken, TooManyTriangles) {
  LoadOptions options;
  options.max_triangles = 1;
  EXPECT_EQ(failure_of(square_glb(), "2 triangles", options), ErrorWord::kTooLarge);
}

TEST(GltfBroken, TooManyTexels) {
  GlbMaker maker = square_glb();
  show_image(maker, encode_png({"", 4, 2, std::vector<std::uint8_t>(32, 255)}));
  LoadOptions options;
  options.max_texels = 8;
  const TemporaryFolder folder;
  EXPECT_EQ(load_scene(folder.write("scene.glb", maker.glb()), options).textures.size(), 1U);
  options.max_texels = 7;
  EXPECT_EQ(failure_of(maker, "8 texels", options), ErrorWord::kTooLarge);
}

// An accessor without bytes is a line of text: what it makes of one mesh must be counted before it is made.
TEST(GltfBroken, InstancesAreCountedBeforeTheyAreMade) {
  GlbMaker maker = square_glb();
  maker.json["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = maker.json["accessors"].size() - 1;
  LoadOptions options;
  options.max_triangles = 1 << 20;
  EXPECT_EQ(failure_of(maker, "33554432 triangles", options), ErrorWord::kTooLarge);
  options.max_triangles = std::uint64_t{1} << 40;
  EXPECT_EQ(failure_of(maker, "16777216 objects", options), ErrorWord::kTooLarge);
}

TEST(GltfBroken, LevelsOfInstancesAreCounted) {
  GlbMaker maker = square_glb();
  maker.json["accessors"].push_back({{"componentType", 5126}, {"count", 100'000}, {"type", "VEC3"}});
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = maker.json["accessors"].size() - 1;
  maker.json["nodes"].push_back({{"mesh", 0}});
  maker.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = std::vector<int>(1000, 1);
  EXPECT_EQ(failure_of(maker, "100000000 levels of detail"), ErrorWord::kTooLarge);
}

TEST(GltfBroken, ElementsWithoutBytesAreLimitedInTheWholeFile) {
  GlbMaker maker = square_glb();
  for (int i = 0; i < 4; ++i) {
    maker.json["accessors"].push_back({{"componentType", 5126}, {"count", (1 << 23) + 1}, {"type", "VEC3"}});
    GlbMaker::Json primitive = maker.primitive();
    primitive["attributes"]["POSITION"] = maker.json["accessors"].size() - 1;
    maker.json["meshes"][0]["primitives"].push_back(primitive);
  }
  EXPECT_EQ(failure_of(maker, "no bytes"), ErrorWord::kFileBroken);
}

// Many buffer views may name the same packed bytes.
TEST(GltfBroken, WhatTheSameBytesUnpackToIsLimited) {
  const std::vector<float> positions(3 * 4096, 1.0F);
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4096, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), 4096, 12));
  GlbMaker maker = square_glb();
  GlbMaker::Json view = maker.json["bufferViews"][maker.view(packed.data(), packed.size())];
  view.update({{"count", 4096}, {"byteStride", 12}, {"mode", "ATTRIBUTES"}});
  for (int i = 0; i < 200; ++i) {
    maker.json["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 4096 * 12}, {"extensions", {{"EXT_meshopt_compression", view}}}});
    maker.json["accessors"].push_back(
        {{"bufferView", maker.json["bufferViews"].size() - 1}, {"componentType", 5126}, {"count", 4096}, {"type", "VEC3"}});
    GlbMaker::Json primitive = maker.primitive();
    primitive["attributes"]["POSITION"] = maker.json["accessors"].size() - 1;
    maker.json["meshes"][0]["primitives"].push_back(primitive);
  }
  EXPECT_EQ(failure_of(maker, "unpack"), ErrorWord::kFileBroken);
}

TEST(GltfBroken, ColoursStayWithinTheirRange) {
  GlbMaker maker = square_glb();
  maker.json["materials"] = GlbMaker::Json::array(
      {{{"alphaMode", "MASK"}, {"alphaCutoff", 1e300}, {"pbrMetallicRoughness", {{"baseColorFactor", {1e300, -1e300, 0.5, 7.0}}}}}});
  maker.primitive()["material"] = 0;
  const TemporaryFolder folder;
  const Material material = load_scene(folder.write("scene.glb", maker.glb())).materials.at(0);
  EXPECT_EQ(material.base_colour.r, 1.0F);
  EXPECT_EQ(material.base_colour.g, 0.0F);
  EXPECT_EQ(material.base_colour.a, 1.0F);
  EXPECT_TRUE(std::isfinite(material.alpha_cutoff));
}

TEST(GltfBroken, BrokenImageIsANoteOnly) {
  GlbMaker maker = square_glb();
  show_image(maker, "no image");
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write("scene.glb", maker.glb()));
  EXPECT_EQ(noted(scene, Kind::kWarning, "textures", "images[0]"), 1U);
  EXPECT_EQ(scene.materials.at(0).texture, -1);
}

}  // namespace
}  // namespace standin
