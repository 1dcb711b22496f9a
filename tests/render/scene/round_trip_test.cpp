// load(write(scene)) shows the same scene, bit for bit.

#include <gtest/gtest.h>

#include <set>

#include "render/scene/city.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

void expect_same(const Texture& a, const Texture& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_TRUE(a.rgba == b.rgba) << a.name;
}

void expect_same(const Scene& a_scene, const Material& a, const Scene& b_scene, const Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.base_colour, b.base_colour);
  EXPECT_EQ(a.alpha_mode, b.alpha_mode);
  EXPECT_EQ(a.alpha_cutoff, b.alpha_cutoff);
  EXPECT_EQ(a.double_sided, b.double_sided);
  EXPECT_EQ(a.unlit, b.unlit);
  ASSERT_EQ(a.texture < 0, b.texture < 0);
  if (a.texture >= 0)
    expect_same(a_scene.textures[static_cast<std::size_t>(a.texture)], b_scene.textures[static_cast<std::size_t>(b.texture)]);
}

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(a.positions == b.positions && a.normals == b.normals && a.uvs == b.uvs && a.indices == b.indices) << a.name;
  EXPECT_EQ(a.bounds, b.bounds);
  EXPECT_EQ(a.area_m2, b.area_m2);
}

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.objects.size(), b.objects.size());
  EXPECT_EQ(a.bounds, b.bounds);
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    const Object& x = a.objects[i];
    const Object& y = b.objects[i];
    ASSERT_EQ(x.name, y.name);
    EXPECT_EQ(x.world_from_object, y.world_from_object);
    EXPECT_EQ(x.bounds, y.bounds);
    EXPECT_EQ(x.area_m2, y.area_m2);
    ASSERT_EQ(x.part_count, y.part_count);
    for (std::uint32_t p = 0; p < x.part_count; ++p) {
      const Part& u = a.parts[x.first_part + p];
      const Part& v = b.parts[y.first_part + p];
      expect_same(a.meshes[u.mesh], b.meshes[v.mesh]);
      expect_same(a, a.materials[u.material], b, b.materials[v.material]);
    }
    ASSERT_FALSE(testing::Test::HasFailure()) << x.name;
  }
}

LoadOptions whole() {
  LoadOptions options;
  options.split_triangles = 0;
  options.split_extent = 0.0;
  return options;
}

TEST(RoundTrip, CityIsTheSameAndStaysInstanced) {
  const test::TemporaryFolder folder;
  const Scene city = make_city({60, 30'000, 3});
  write_scene_glb(city, folder.path() / "city.glb");
  const Scene back = load_scene(folder.path() / "city.glb", whole());
  expect_same(city, back);
  EXPECT_EQ(back.meshes.size(), city.meshes.size());
  EXPECT_EQ(back.objects[1].gltf_node, city.objects[1].name);
  EXPECT_EQ(test::noted(back, LoadNote::Kind::kDropped, ""), 0U);
  EXPECT_EQ(test::noted(back, LoadNote::Kind::kRepaired, ""), 0U);
}

TEST(RoundTrip, WritingTwiceGivesTheSameBytes) {
  const test::TemporaryFolder folder;
  const Scene city = make_city({20, 8'000, 5});
  write_scene_glb(city, folder.path() / "a.glb");
  const Scene a = load_scene(folder.path() / "a.glb", whole());
  write_scene_glb(a, folder.path() / "b.glb");
  write_scene_glb(city, folder.path() / "a.glb");
  EXPECT_EQ(load_scene(folder.path() / "a.glb", whole()).sha256, a.sha256);
  const Scene b = load_scene(folder.path() / "b.glb", whole());
  EXPECT_EQ(a.sha256.size(), 64U);
  write_scene_glb(b, folder.path() / "c.glb");
  EXPECT_EQ(load_scene(folder.path() / "c.glb", whole()).sha256, b.sha256) << "reading and writing has a fixed point";
}

TEST(RoundTrip, UnlitMaskedAndCoarseIndices) {
  const test::TemporaryFolder folder;
  Scene city = make_city({16, 500'000, 1});  // a tree of more than 65,535 vertices
  for (Material& material : city.materials)
    material = Material{material.name, {0.1F, 0.2F, 0.3F, 0.4F}, material.texture, AlphaMode::kMask, 0.3F, false, true};
  write_scene_glb(city, folder.path() / "city.glb");
  expect_same(city, load_scene(folder.path() / "city.glb", whole()));
}

TEST(RoundTrip, NothingIsLeftWhereTheFolderIsMissing) {
  const test::TemporaryFolder folder;
  try {
    write_scene_glb(make_city({16, 3'200, 1}), folder.path() / "no" / "city.glb");
    FAIL() << "wrote into a missing folder";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileMissing);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace standin
