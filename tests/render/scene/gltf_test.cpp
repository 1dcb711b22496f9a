// What glTF says, and that it is what we read.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>

#include "render/image/image_io.h"
#include "render/scene/file_access.h"
#include "tests/render/scene/glb_maker.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using test::GlbMaker;
using test::noted;
using test::square_glb;
using test::TemporaryFolder;
using Json = GlbMaker::Json;
using Kind = LoadNote::Kind;

Scene loaded(const GlbMaker& maker, const LoadOptions& options = {}) {
  const TemporaryFolder folder;
  return load_scene(folder.write("scene.glb", maker.glb()), options);
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-6) {
  EXPECT_LE(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z << " instead of " << b.x << " " << b.y << " " << b.z;
}

TEST(Gltf, SquareWithFlatNormals) {
  const Scene scene = loaded(square_glb());
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].name, "node");
  EXPECT_EQ(scene.objects[0].gltf_node, "node");
  EXPECT_EQ(scene.triangle_count(), 2U);
  EXPECT_DOUBLE_EQ(scene.objects[0].area_m2, 1.0);
  EXPECT_EQ(scene.meshes[0].positions.size(), 6U);
  for (const glm::vec3& normal : scene.meshes[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  EXPECT_EQ(noted(scene, Kind::kRepaired, "meshes", "no normals"), 1U);
  EXPECT_EQ(scene.name, "scene.glb");
  EXPECT_EQ(scene.sha256.size(), 64U);
}

TEST(Gltf, TransformsMultiplyDownTheTree) {
  GlbMaker maker = square_glb();
  maker.json["scenes"][0]["nodes"] = {1};
  maker.json["nodes"][0]["translation"] = {1, 0, 0};
  // A quarter turn about z, then twice the size, then up by 10.
  maker.json["nodes"].push_back(
      {{"children", {0}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 2, 2}}, {"translation", {0, 10, 0}}});
  const Scene scene = loaded(maker);
  expect_near(scene.bounds.min, {-2, 12, 0});
  expect_near(scene.bounds.max, {0, 14, 0});
  EXPECT_NEAR(scene.objects[0].area_m2, 4.0, 1e-9);
}

TEST(Gltf, UnevenScaleScalesAreas) {
  GlbMaker maker = square_glb();
  maker.json["nodes"][0]["scale"] = {3, 5, 7};
  EXPECT_NEAR(loaded(maker).objects[0].area_m2, 15.0, 1e-9);
}

TEST(Gltf, StripsAndFansKeepTheirOrientation) {
  for (const int mode : {5, 6}) {
    GlbMaker maker;
    const std::vector<std::uint32_t> corners = mode == 5 ? std::vector<std::uint32_t>{0, 1, 3, 2} : std::vector<std::uint32_t>{0, 1, 2, 3};
    maker.show({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, corners);
    maker.primitive()["mode"] = mode;
    const Scene scene = loaded(maker);
    EXPECT_EQ(scene.triangle_count(), 2U);
    EXPECT_DOUBLE_EQ(scene.objects[0].area_m2, 1.0);
    for (const glm::vec3& normal : scene.meshes[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1)) << "mode " << mode;
  }
}

TEST(Gltf, NoIndicesMeansInOrder) {
  GlbMaker maker;
  maker.show({0, 0, 0, 2, 0, 0, 0, 2, 0}, {});
  EXPECT_DOUBLE_EQ(loaded(maker).objects[0].area_m2, 2.0);
}

TEST(Gltf, QuantisedPositionsAndNormals) {
  GlbMaker maker;
  Json primitive{{"indices", maker.indices({0, 1, 2})}};
  // Three components and a byte or short of padding: stride 8 and 4.
  primitive["attributes"]["POSITION"] =
      maker.accessor(std::vector<std::uint16_t>{0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}, 5123, "VEC4");
  maker.json["accessors"].back()["type"] = "VEC3";
  maker.json["accessors"].back()["normalized"] = true;
  maker.json["bufferViews"].back()["byteStride"] = 8;
  maker.json["accessors"].back()["count"] = 3;
  primitive["attributes"]["NORMAL"] = maker.accessor(std::vector<std::int8_t>{0, 0, -127, 0, 0, 0, -128, 0, 0, 0, -127, 0}, 5120, "VEC4");
  maker.json["accessors"].back()["type"] = "VEC3";
  maker.json["accessors"].back()["normalized"] = true;
  maker.json["bufferViews"].back()["byteStride"] = 4;
  maker.json["meshes"].push_back({{"primitives", {primitive}}});
  maker.json["nodes"].push_back({{"mesh", 0}});
  maker.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Scene scene = loaded(maker);
  EXPECT_DOUBLE_EQ(scene.objects[0].area_m2, 0.5);
  for (const glm::vec3& normal : scene.meshes[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, -1));
}

TEST(Gltf, SparseAccessorReplacesElements) {
  GlbMaker maker = square_glb();
  const std::size_t which = maker.view(std::vector<std::uint16_t>{2}.data(), 2);
  const std::size_t what = maker.view(std::vector<float>{3, 3, 0}.data(), 12);
  maker.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", which}, {"componentType", 5123}}}, {"values", {{"bufferView", what}}}};
  EXPECT_DOUBLE_EQ(loaded(maker).objects[0].area_m2, 3.0);
  maker.json["accessors"][0]["sparse"]["count"] = 2;
  const TemporaryFolder folder;
  EXPECT_EQ(test::load_failure(folder.write("scene.glb", maker.glb()), "do not fit"), ErrorWord::kFileBroken);
}

TEST(Gltf, MeshoptCompression) {
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::uint32_t> corners{0, 1, 2, 0, 2, 3};
  std::vector<unsigned char> packed_vertices(meshopt_encodeVertexBufferBound(4, 12));
  packed_vertices.resize(meshopt_encodeVertexBuffer(packed_vertices.data(), packed_vertices.size(), positions.data(), 4, 12));
  std::vector<unsigned char> packed_indices(meshopt_encodeIndexBufferBound(6, 4));
  packed_indices.resize(meshopt_encodeIndexBuffer(packed_indices.data(), packed_indices.size(), corners.data(), 6));
  GlbMaker maker = square_glb();
  const auto pack = [&](std::size_t view, const std::vector<unsigned char>& bytes, std::size_t count, std::size_t stride,
                        const char* mode) {
    Json extension = maker.json["bufferViews"][maker.view(bytes.data(), bytes.size())];
    extension.update({{"count", count}, {"byteStride", stride}, {"mode", mode}});
    maker.json["bufferViews"][view] = {
        {"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  };
  pack(0, packed_vertices, 4, 12, "ATTRIBUTES");
  pack(1, packed_indices, 6, 4, "TRIANGLES");
  maker.json["buffers"] = Json::array({{{"byteLength", maker.binary.size()}}, {{"byteLength", 100}}});  // the second is the fallback
  maker.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  EXPECT_DOUBLE_EQ(loaded(maker).objects[0].area_m2, 1.0);
  const TemporaryFolder folder;
  maker.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 1'000'000'000;
  EXPECT_EQ(test::load_failure(folder.write("scene.glb", maker.glb()), "claims"), ErrorWord::kFileBroken);
}

TEST(Gltf, GpuInstancesAreObjectsThatShareTheirMesh) {
  GlbMaker maker = square_glb();
  const std::size_t places = maker.floats({0, 0, 0, 5, 0, 0, 9, 0, 0}, "VEC3");
  const std::size_t sizes = maker.floats({1, 1, 1, 2, 2, 2, 3, 3, 3}, "VEC3");
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", places}, {"SCALE", sizes}};
  const Scene scene = loaded(maker);
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.objects[2].name, "node[2]");
  EXPECT_DOUBLE_EQ(scene.objects[2].bounds.min.x, 9.0);
  EXPECT_DOUBLE_EQ(scene.objects[2].area_m2, 9.0);
}

// Red 0.5 linear is 0.7354 encoded.
TEST(Gltf, MaterialsAsTheShadingRuleWantsThem) {
  GlbMaker maker = square_glb();
  maker.json["materials"] = Json::array({{{"name", "half"},
                                          {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.0, 1.0, 0.25}}}},
                                          {"alphaMode", "MASK"},
                                          {"alphaCutoff", 0.2},
                                          {"doubleSided", true},
                                          {"extensions", {{"KHR_materials_unlit", Json::object()}}}}});
  maker.primitive()["material"] = 0;
  const Scene scene = loaded(maker);
  const Material& material = scene.materials.at(0);
  EXPECT_NEAR(material.base_colour.r, 0.735357F, 1e-5F);
  EXPECT_EQ(material.base_colour.g, 0.0F);
  EXPECT_EQ(material.base_colour.b, 1.0F);
  EXPECT_EQ(material.base_colour.a, 0.25F);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(material.alpha_cutoff, 0.2F);
  EXPECT_TRUE(material.double_sided);
  EXPECT_TRUE(material.unlit);
}

TEST(Gltf, SpecularGlossinessIsReadAsDiffuse) {
  GlbMaker maker = square_glb();
  maker.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
  maker.json["materials"] = Json::array({{{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0, 1, 0, 1}}}}}}}});
  maker.primitive()["material"] = 0;
  EXPECT_EQ(loaded(maker).materials.at(0).base_colour, glm::vec4(0, 1, 0, 1));
}

TEST(Gltf, BlendBecomesAMaskAndIsNoted) {
  GlbMaker maker = square_glb();
  maker.json["materials"] = Json::array({{{"alphaMode", "BLEND"}}});
  maker.primitive()["material"] = 0;
  const Scene scene = loaded(maker);
  EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(scene.materials.at(0).alpha_cutoff, 0.5F);
  EXPECT_EQ(noted(scene, Kind::kChosen, "materials", "blended"), 1U);
}

TEST(Gltf, TextureTransformIsAppliedToTheCoordinates) {
  GlbMaker maker = square_glb();
  const std::string png = encode_png({"dot", 1, 1, {1, 2, 3, 255}});
  maker.json["images"] = Json::array({{{"bufferView", maker.view(png.data(), png.size())}, {"mimeType", "image/png"}, {"name", "dot"}}});
  maker.json["textures"] = Json::array({{{"source", 0}}});
  const Json transform{{"offset", {0.5, 0.25}}, {"scale", {2, 4}}, {"rotation", std::acos(0.0)}};
  maker.json["materials"] = Json::array(
      {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}});
  maker.primitive()["material"] = 0;
  maker.primitive()["attributes"]["TEXCOORD_0"] = maker.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  maker.primitive()["attributes"]["NORMAL"] = maker.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const Scene scene = loaded(maker);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_THAT(scene.textures[0].rgba, testing::ElementsAre(1, 2, 3, 255));
  // A quarter turn counter-clockwise on the image (v down): (u, v) -> (v, -u), after scaling by (2, 4), before the offset.
  const auto& uvs = scene.meshes[0].uvs;
  ASSERT_EQ(uvs.size(), 4U);
  EXPECT_NEAR(uvs[1].x, 0.5F, 1e-6F);
  EXPECT_NEAR(uvs[1].y, -1.75F, 1e-6F);
  EXPECT_NEAR(uvs[2].x, 4.5F, 1e-6F);
  EXPECT_NEAR(uvs[2].y, -1.75F, 1e-6F);
}

TEST(Gltf, ExternalAndDataUris) {
  const TemporaryFolder folder;
  GlbMaker maker = square_glb();
  (void)folder.write("sub/the data.bin", maker.binary);
  maker.json["buffers"] = Json::array({{{"byteLength", maker.binary.size()}, {"uri", "sub/the%20data.bin"}}});
  EXPECT_EQ(load_scene(folder.write("scene.gltf", maker.json.dump())).triangle_count(), 2U);
  GlbMaker tiny;
  tiny.show({0, 0, 0, 1, 0, 0, 0, 1, 0}, {});
  // The nine floats above in base64.
  const std::string uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  tiny.json["buffers"] = Json::array({{{"byteLength", 36}, {"uri", uri}}});
  EXPECT_DOUBLE_EQ(load_scene(folder.write("tiny.gltf", tiny.json.dump())).objects[0].area_m2, 0.5);
}

// Positions of 1 mm steps, 100 km away in the node's frame: exact again after re-centring.
TEST(Gltf, FarMeshesAreRecentred) {
  GlbMaker maker;
  const float far = 65536.0F;
  maker.show({far, 0, far, far + 0.5F, 0, far, far, 0.5F, far}, {0, 1, 2});
  const Scene scene = loaded(maker);
  EXPECT_LT(glm::length(scene.meshes[0].bounds.centre()), 1.0);
  expect_near(scene.bounds.min, {far, 0, far}, 0.0);
  expect_near(scene.bounds.max, {far + 0.5, 0.5, far}, 0.0);
}

TEST(Gltf, PlacingTurnsAndScales) {
  LoadOptions options;
  options.placing.up = UpAxis::kZ;
  options.placing.metres_per_unit = 0.5;
  GlbMaker maker;
  maker.show({0, 0, 0, 2, 0, 0, 0, 4, 6}, {0, 1, 2});
  const Scene scene = loaded(maker, options);
  // (x, y, z) -> (x, z, -y) / 2
  expect_near(scene.bounds.min, {0, 0, -2});
  expect_near(scene.bounds.max, {1, 3, 0});
  EXPECT_NEAR(glm::determinant(scene.world_from_file), 0.125, 1e-15);
  EXPECT_EQ(noted(scene, Kind::kChosen, "up axis z", "as asked"), 1U);
  options.placing.up = UpAxis::kX;
  // (x, y, z) -> (-y, x, z) / 2
  expect_near(loaded(maker, options).bounds.min, {-2, 0, 0});
}

}  // namespace
}  // namespace standin
