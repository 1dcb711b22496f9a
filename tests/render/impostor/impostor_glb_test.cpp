// The GLB as a reader sees it: chunks, accessors within their views, positions on their layers, pages that decode to the atlas.
#include "render/impostor/impostor_glb.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "render/image/image_io.h"
#include "render/impostor/atlas.h"

namespace standin {
namespace {

using nlohmann::json;

struct Parsed {
  json document;
  std::string binary;
};

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, 4);
  return word;
}

Parsed parse(const std::string& glb) {
  Parsed parsed;
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(glb, 4), 2U);
  EXPECT_EQ(word_at(glb, 8), glb.size());
  const std::size_t json_size = word_at(glb, 12);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0U);
  parsed.document = json::parse(glb.substr(20, json_size));
  if (20 + json_size < glb.size()) {
    EXPECT_EQ(word_at(glb, 24 + json_size), 0x004E4942U);
    parsed.binary = glb.substr(28 + json_size);
    EXPECT_EQ(parsed.binary.size(), word_at(glb, 20 + json_size));
  }
  return parsed;
}

Impostor impostor_at(const Vec3& viewpoint, std::vector<Quad> quads) {
  Impostor impostor;
  impostor.frame.reference_viewpoint = viewpoint;
  impostor.frame.slope_min = {-0.5, 0.5};
  impostor.frame.slope_step = Vec2(1.0 / 64);
  impostor.frame.width = impostor.frame.height = 64;
  impostor.layers = {{10.0, 9.0, 11.0}, {12.0, 11.0, 13.0}};
  for (const Quad& quad : quads)
    for (std::uint32_t k = 0; k < quad.width * quad.height; ++k)
      for (const unsigned c : {10U + k % 200, 20U, 30U, 255U}) impostor.texels.push_back(static_cast<std::uint8_t>(c));
  impostor.quads = std::move(quads);
  return impostor;
}

ImpostorSet small_set() {
  return pack_atlas({impostor_at({1e4 + 0.123456789, 2.0, -3.0}, {{0, 1, 2, 20, 10}, {1, 30, 30, 7, 9}}), impostor_at({5.0, 6.0, 7.0}, {}),
                     impostor_at({0.0, 0.0, 0.0}, {{1, 0, 0, 30, 30}, {0, 3, 3, 25, 25}})},
                    {.max_side = 40});
}

TEST(ImpostorGlb, HoldsOneNodePerImpostorAtItsViewpoint) {
  const ImpostorSet set = small_set();
  const json document = parse(encode_impostor_glb(set)).document;
  ASSERT_EQ(document.at("nodes").size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const json& node = document.at("nodes").at(i);
    EXPECT_EQ(node.at("name"), "imp_" + std::to_string(i));
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(node.at("translation").at(static_cast<std::size_t>(axis)).get<double>(), set.impostors[i].frame.reference_viewpoint[axis]);
    EXPECT_EQ(node.contains("mesh"), !set.impostors[i].quads.empty());
  }
  ASSERT_GT(set.pages.size(), 1U);
  for (const json& material : document.at("materials")) {
    EXPECT_EQ(material.at("alphaMode"), "MASK");
    EXPECT_TRUE(material.at("doubleSided").get<bool>());
    EXPECT_TRUE(material.at("extensions").contains("KHR_materials_unlit"));
  }
  EXPECT_EQ(document.at("samplers").at(0).at("magFilter"), 9728);
}

TEST(ImpostorGlb, AccessorsLieWithinTheirViewsAndBoundTheirPositions) {
  const Parsed glb = parse(encode_impostor_glb(small_set()));
  for (const json& view : glb.document.at("bufferViews")) {
    EXPECT_EQ(view.at("byteOffset").get<std::size_t>() % 4, 0U);
    EXPECT_LE(view.at("byteOffset").get<std::size_t>() + view.at("byteLength").get<std::size_t>(), glb.binary.size());
  }
  for (const json& accessor : glb.document.at("accessors")) {
    const json& view = glb.document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const std::size_t count = accessor.at("count"), begin = accessor.at("byteOffset");
    const std::size_t size = accessor.at("type") == "VEC3" ? 12 : accessor.at("type") == "VEC2" ? 8 : 2;
    ASSERT_LE(begin + count * size, view.at("byteLength").get<std::size_t>());
    if (accessor.at("type") != "VEC3") continue;
    Box bounds;
    for (std::size_t i = 0; i < count; ++i) {
      glm::vec3 p(0.0F);
      std::memcpy(&p, glb.binary.data() + view.at("byteOffset").get<std::size_t>() + begin + 12 * i, 12);
      bounds.extend(Vec3(p));
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(accessor.at("min").at(static_cast<std::size_t>(axis)).get<float>(), static_cast<float>(bounds.min[axis]));
      EXPECT_EQ(accessor.at("max").at(static_cast<std::size_t>(axis)).get<float>(), static_cast<float>(bounds.max[axis]));
    }
  }
}

TEST(ImpostorGlb, QuadsShowTheirTexelsOnTheirLayers) {
  const ImpostorSet set = small_set();
  const Parsed glb = parse(encode_impostor_glb(set));
  const auto floats = [&](const json& accessor) {
    const json& view = glb.document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    return reinterpret_cast<const float*>(glb.binary.data() + view.at("byteOffset").get<std::size_t>() +
                                          accessor.at("byteOffset").get<std::size_t>());
  };
  const json& primitives = glb.document.at("meshes").at(0).at("primitives");
  std::size_t corner_of_impostor = 0;
  for (const json& primitive : primitives) {
    const json& positions = glb.document.at("accessors").at(primitive.at("attributes").at("POSITION").get<std::size_t>());
    const json& uvs = glb.document.at("accessors").at(primitive.at("attributes").at("TEXCOORD_0").get<std::size_t>());
    for (std::size_t i = 0; i < positions.at("count").get<std::size_t>(); i += 4, ++corner_of_impostor) {
      const Quad& quad = set.impostors[0].quads[corner_of_impostor];
      const AtlasSlot& slot = set.slots[0][corner_of_impostor];
      const float* p = floats(positions) + 3 * i;  // upper left
      const double depth = set.impostors[0].layers[quad.layer].distance_m;
      EXPECT_NEAR(p[0], depth * (-0.5 + quad.x / 64.0), 1e-5);
      EXPECT_NEAR(p[1], depth * (0.5 - quad.y / 64.0), 1e-5);
      EXPECT_NEAR(p[2], -depth, 1e-5);
      const float* uv = floats(uvs) + 2 * (i + 2);  // lower right
      EXPECT_NEAR(uv[0] * static_cast<float>(set.pages[slot.page].width), slot.x + quad.width, 1e-4);
      EXPECT_NEAR(uv[1] * static_cast<float>(set.pages[slot.page].height), slot.y + quad.height, 1e-4);
    }
  }
  EXPECT_EQ(corner_of_impostor, set.impostors[0].quads.size());
}

TEST(ImpostorGlb, PagesDecodeToTheAtlas) {
  const ImpostorSet set = small_set();
  const Parsed glb = parse(encode_impostor_glb(set));
  ASSERT_EQ(glb.document.at("images").size(), set.pages.size());
  for (std::size_t i = 0; i < set.pages.size(); ++i) {
    const json& view = glb.document.at("bufferViews").at(glb.document.at("images").at(i).at("bufferView").get<std::size_t>());
    const auto* first = reinterpret_cast<const std::uint8_t*>(glb.binary.data()) + view.at("byteOffset").get<std::size_t>();
    const Texture page = decode_image({first, view.at("byteLength").get<std::size_t>()}, "page");
    EXPECT_EQ(page.width, set.pages[i].width);
    EXPECT_EQ(page.rgba, set.pages[i].rgba);
  }
}

TEST(ImpostorGlb, CountsTheBytesThatItHolds) {
  const ImpostorSet set = small_set();
  const json document = parse(encode_impostor_glb(set)).document;
  std::uint64_t counted = 0, held = 0;
  for (const Impostor& impostor : set.impostors) counted += geometry_bytes(impostor);
  for (std::size_t view = 0; view < 3; ++view) held += document.at("bufferViews").at(view).at("byteLength").get<std::uint64_t>();
  EXPECT_EQ(counted, held);
}

TEST(ImpostorGlb, EmptySetsAreValidToo) {
  const json nothing = parse(encode_impostor_glb({})).document;
  EXPECT_FALSE(nothing.contains("nodes"));
  EXPECT_FALSE(nothing.contains("buffers"));
  const json unseen = parse(encode_impostor_glb(pack_atlas({impostor_at(Vec3(1.0), {})}))).document;
  EXPECT_EQ(unseen.at("nodes").size(), 1U);
  EXPECT_FALSE(unseen.contains("meshes"));
}

TEST(ImpostorGlb, IsTheSameEachTime) {
  EXPECT_EQ(encode_impostor_glb(small_set()), encode_impostor_glb(small_set()));
}

}  // namespace
}  // namespace standin
