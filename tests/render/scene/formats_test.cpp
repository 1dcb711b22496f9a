// Formats that Assimp reads, and what we hold it to.

#include <gtest/gtest.h>

#include "render/image/image_io.h"
#include "render/scene/ac3d.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using test::load_failure;
using test::noted;
using test::TemporaryFolder;
using Kind = LoadNote::Kind;

const std::string kQuad = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

std::string png(std::uint8_t alpha) {
  return encode_png({"texel", 1, 1, {10, 20, 30, alpha}});
}

TEST(Formats, ObjWithMaterialAndTexture) {
  const TemporaryFolder folder;
  (void)folder.write("wall.png", png(255));
  (void)folder.write("scene.mtl", "newmtl wall\nKd 1 0.5 0.25\nmap_Kd wall.png\n");
  const Scene scene = load_scene(folder.write("scene.obj", "mtllib scene.mtl\no wall\n" + kQuad + "usemtl wall\nf 1/1 2/2 3/3 4/4\n"));
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].name, "wall");
  EXPECT_EQ(scene.triangle_count(), 2U);
  EXPECT_DOUBLE_EQ(scene.objects[0].area_m2, 2.0);
  const Material& material = scene.materials.at(0);
  EXPECT_EQ(material.base_colour, glm::vec4(1.0F, 0.5F, 0.25F, 1.0F));
  ASSERT_EQ(material.texture, 0);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kOpaque);
  EXPECT_EQ(scene.textures[0].rgba, (std::vector<std::uint8_t>{10, 20, 30, 255}));
  // OBJ counts v from below, Scene from above.
  for (std::size_t i = 0; i < scene.meshes[0].uvs.size(); ++i) {
    EXPECT_FLOAT_EQ(scene.meshes[0].uvs[i].y, 1.0F - scene.meshes[0].positions[i].y);
  }
  EXPECT_EQ(noted(scene, Kind::kChosen, "up axis y", "does not say"), 1U);
  EXPECT_EQ(noted(scene, Kind::kChosen, "metres per unit", "does not say"), 1U);
}

TEST(Formats, TextureWithHolesMakesAMask) {
  const TemporaryFolder folder;
  (void)folder.write("leaf.png", png(0));
  (void)folder.write("scene.mtl", "newmtl leaf\nmap_Kd leaf.png\n");
  const Scene scene = load_scene(folder.write("scene.obj", "mtllib scene.mtl\n" + kQuad + "usemtl leaf\nf 1/1 2/2 3/3 4/4\n"));
  EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(noted(scene, Kind::kChosen, "materials", "holes"), 1U);
}

TEST(Formats, TexturesAreFoundByFileNameOnlyWhereAllowed) {
  const TemporaryFolder folder;
  (void)folder.write("outside/wall.png", png(255));
  (void)folder.write("scene/scene.mtl", "newmtl wall\nmap_Kd ../outside/wall.png\n");
  const auto file = folder.write("scene/scene.obj", "mtllib scene.mtl\n" + kQuad + "usemtl wall\nf 1/1 2/2 3/3 4/4\n");
  const Scene without = load_scene(file);
  EXPECT_EQ(without.textures.size(), 0U);
  EXPECT_EQ(noted(without, Kind::kWarning, "textures", "wall.png"), 1U);
  LoadOptions options;
  options.texture_folders = {folder.path() / "outside"};
  EXPECT_EQ(load_scene(file, options).textures.size(), 1U);
  (void)folder.write("scene/wall.png", png(255));
  EXPECT_EQ(load_scene(file).textures.size(), 1U);
}

TEST(Formats, MaterialFilesOutsideTheFolderAreRefused) {
  const TemporaryFolder folder;
  (void)folder.write("secret.mtl", "newmtl wall\n");
  const auto file = folder.write("scene/scene.obj", "mtllib ../secret.mtl\n" + kQuad + "f 1 2 3\n");
  EXPECT_EQ(load_failure(file, "secret.mtl"), ErrorWord::kUriForbidden);
}

TEST(Formats, AsciiStl) {
  const TemporaryFolder folder;
  const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 0 2 0\nendloop\nendfacet\n";
  LoadOptions options;
  options.placing.metres_per_unit = 0.001;
  const Scene scene = load_scene(folder.write("part.stl", "solid part\n" + facet + "endsolid part\n"), options);
  EXPECT_EQ(scene.triangle_count(), 1U);
  EXPECT_NEAR(scene.objects[0].area_m2, 3e-6, 1e-15);
}

TEST(Formats, LinesAndPointsAreCounted) {
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write("scene.obj", kQuad + "f 1 2 3\nl 1 2\nl 2 3\n"));
  EXPECT_EQ(scene.triangle_count(), 1U);
  EXPECT_EQ(noted(scene, Kind::kDropped, "points and lines"), 2U);
}

TEST(Formats, ASurfaceWithoutCornersIsNone) {
  const TemporaryFolder folder;
  const Scene scene = load_scene(folder.write(
      "scene.ac",
      "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\nOBJECT poly\nnumvert 3\n"
      "0 0 0\n1 0 0\n0 1 0\nnumsurf 2\nSURF 0x20\nmat 0\nrefs 0\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n"));
  EXPECT_EQ(scene.triangle_count(), 1U);
  EXPECT_EQ(load_failure(folder.write("none.ac",
                                      "AC3Db\nMATERIAL \"m\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\n"
                                      "kids 1\nOBJECT poly\nnumvert 1\n0 0 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\n"
                                      "kids 0\n")),
            ErrorWord::kSceneEmpty);
}

TEST(Formats, NoSceneAtAll) {
  const TemporaryFolder folder;
  EXPECT_EQ(load_failure(folder.write("words.obj", "these are words\n"), "words.obj"), ErrorWord::kSceneEmpty);
  EXPECT_EQ(load_failure(folder.write("picture.xyz", "unknown ending"), "picture.xyz"), ErrorWord::kFileBroken);
  EXPECT_EQ(load_failure(folder.write("cut.stl", std::string(84, '\7')), "cut.stl"), ErrorWord::kFileBroken);
}

std::string track(const std::string& textures) {
  return "AC3Db\nMATERIAL \"m\" rgb 1 1 1  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0\nOBJECT world\nkids 1\nOBJECT poly\n"
         "name \"road\"\n" +
         textures + "numvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 1 0\n2 0 1\nkids 0\n";
}

TEST(Formats, TorcsTracksWearTheirBaseTexture) {
  const TemporaryFolder folder;
  (void)folder.write("road.png", png(255));
  const std::string layers = "texture \"road.png\" base\ntexture \"shadow.rgb\" tiled\ntexture empty_texture_no_mapping skids\n";
  const Scene scene = load_scene(folder.write("track.acc", track(layers)));
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.textures[0].name, "road.png");
  EXPECT_EQ(noted(scene, Kind::kWarning, "textures"), 0U);
}

TEST(Formats, OnlyLightingLayersAreStruckFromAc3d) {
  EXPECT_EQ(with_base_textures_only("a\ntexture \"x\" base\r\ntexture \"y\" tiled\r\ntexture \"z\"\ntexture n shad"),
            "a\ntexture \"x\" base\r\ntexture \"z\"\n");
  EXPECT_EQ(with_base_textures_only(""), "");
}

}  // namespace
}  // namespace standin
