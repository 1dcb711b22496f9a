#include "server/cache/object_content.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/server/cache/painted_scene.h"

namespace standin {
namespace {

using test::kBlock, test::kCrate, test::kPane;

/// One edit of an object, and which stages' contents of it change.
struct Edit {
  const char* what;
  std::uint32_t object;
  std::function<void(Scene&)> change;
  bool ray, cost, look;
};

Mesh& mesh_of(Scene& scene, std::uint32_t object) {
  return scene.meshes[scene.parts[scene.objects[object].first_part].mesh];
}

Material& material_of(Scene& scene, std::uint32_t object) {
  return scene.materials[scene.parts[scene.objects[object].first_part].material];
}

Texture& texture_of(Scene& scene, std::uint32_t object) {
  return scene.textures[static_cast<std::size_t>(material_of(scene, object).texture)];
}

const std::vector<Edit>& edits() {
  static const std::vector<Edit> list = {
      {"moved", kBlock, [](Scene& s) { s.objects[kBlock].world_from_object[3].x += 0.001; }, true, true, true},
      {"a vertex", kCrate, [](Scene& s) { mesh_of(s, kCrate).positions[3].y += 0.125F; }, true, true, true},
      {"a triangle turned", kBlock, [](Scene& s) { std::swap(mesh_of(s, kBlock).indices[0], mesh_of(s, kBlock).indices[1]); }, true, true,
       true},
      {"a triangle less", kBlock, [](Scene& s) { mesh_of(s, kBlock).indices.resize(33); }, true, true, true},
      {"a normal", kCrate, [](Scene& s) { mesh_of(s, kCrate).normals[3].y += 0.125F; }, false, false, true},
      {"coordinates of an opaque texture", kCrate, [](Scene& s) { mesh_of(s, kCrate).uvs[3].y += 0.125F; }, false, false, true},
      {"coordinates of a mask", kPane, [](Scene& s) { mesh_of(s, kPane).uvs[3].y += 0.125F; }, true, false, true},
      {"no coordinates", kCrate, [](Scene& s) { mesh_of(s, kCrate).uvs.clear(); }, false, true, true},
      {"a colour", kBlock, [](Scene& s) { material_of(s, kBlock).base_colour.r = 0.5F; }, false, false, true},
      {"the colour of a masked one", kPane, [](Scene& s) { material_of(s, kPane).base_colour.r = 0.5F; }, false, false, true},
      {"a masked one's alpha", kPane, [](Scene& s) { material_of(s, kPane).base_colour.a = 0.75F; }, true, false, true},
      {"the cutoff of a mask", kPane, [](Scene& s) { material_of(s, kPane).alpha_cutoff = 0.25F; }, true, false, true},
      {"the cutoff of none", kCrate, [](Scene& s) { material_of(s, kCrate).alpha_cutoff = 0.25F; }, false, false, true},
      {"a texel of an opaque texture", kCrate, [](Scene& s) { texture_of(s, kCrate).rgba[0] ^= 1; }, false, false, true},
      {"alpha of an opaque texture", kCrate, [](Scene& s) { texture_of(s, kCrate).rgba[3] ^= 1; }, false, false, true},
      {"a texel's colour in a mask", kPane, [](Scene& s) { texture_of(s, kPane).rgba[0] ^= 1; }, false, false, true},
      {"a texel's alpha in a mask", kPane, [](Scene& s) { texture_of(s, kPane).rgba[3] ^= 1; }, true, false, true},
      {"a mask", kCrate, [](Scene& s) { material_of(s, kCrate).alpha_mode = AlphaMode::kMask; }, true, true, true},
      {"no texture", kCrate, [](Scene& s) { material_of(s, kCrate).texture = -1; }, false, true, true},
      {"one-sided", kBlock, [](Scene& s) { material_of(s, kBlock).double_sided = false; }, false, true, true},
      {"unlit", kBlock, [](Scene& s) { material_of(s, kBlock).unlit = true; }, false, false, true},
      {"from where a level is shown", kCrate, [](Scene& s) { s.objects[kCrate].levels[0].least_distance_m = 40.0; }, false, true, false},
      {"no level", kCrate, [](Scene& s) { s.objects[kCrate].levels.clear(); }, false, true, false},
      {"a level of another mesh", kCrate, [](Scene& s) { s.parts[3].mesh = s.parts[kPane].mesh; }, false, true, false},
      {"a name", kCrate, [](Scene& s) { s.objects[kCrate].name = mesh_of(s, kCrate).name = material_of(s, kCrate).name = "x"; }, false,
       false, false},
  };
  return list;
}

// The plain material is also that of the crate's level.
bool may_change(const Edit& edit, std::uint32_t object) {
  return object == edit.object || (edit.object == kBlock && object == kCrate);
}

TEST(ObjectContent, ChangesWithWhatTheStageLooksAtAndWithNothingElse) {
  const Scene before = test::painted_scene();
  for (const Edit& edit : edits()) {
    Scene after = before;
    edit.change(after);
    update_derived(after);
    EXPECT_EQ(ray_contents(after)[edit.object] != ray_contents(before)[edit.object], edit.ray) << edit.what << " for rays";
    EXPECT_EQ(cost_contents(after)[edit.object] != cost_contents(before)[edit.object], edit.cost) << edit.what << " for costs";
    EXPECT_EQ(look_contents(after)[edit.object] != look_contents(before)[edit.object], edit.look) << edit.what << " for bakes";
    for (std::uint32_t other = 0; other < before.objects.size(); ++other) {
      if (may_change(edit, other)) continue;
      EXPECT_EQ(ray_contents(after)[other], ray_contents(before)[other]) << edit.what << " of object " << edit.object;
      EXPECT_EQ(cost_contents(after)[other], cost_contents(before)[other]) << edit.what << " of object " << edit.object;
      EXPECT_EQ(look_contents(after)[other], look_contents(before)[other]) << edit.what << " of object " << edit.object;
    }
  }
}

TEST(ObjectContent, DoesNotDependOnNumbers) {
  const Scene before = test::painted_scene();
  const Scene after = test::with_one_in_front(before);
  for (const auto contents : {ray_contents, cost_contents, look_contents}) {
    const auto alone = contents(before);
    const auto behind = contents(after);
    ASSERT_EQ(behind.size(), alone.size() + 1);
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), behind.begin() + 1));
  }
}

// A simplified mesh's samples are those of the mesh that it came from.
TEST(ObjectContent, OfALevelHoldsTheMeshThatItIsSimplifiedFrom) {
  Scene scene = test::painted_scene();
  Mesh simpler = scene.meshes[scene.parts[kBlock].mesh];
  simpler.indices.resize(24);
  simpler.simplified_from = static_cast<std::int32_t>(scene.parts[kPane].mesh);
  test::add_mesh(scene, simpler);
  scene.parts[3].mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  const auto before = cost_contents(scene)[kCrate];
  scene.meshes[scene.parts[kPane].mesh].positions[0].x -= 0.5F;
  EXPECT_NE(cost_contents(scene)[kCrate], before);
}

Fingerprint sharing_of(const Scene& scene, const std::vector<std::uint32_t>& objects) {
  Fingerprinter to;
  add_sharing(scene, objects, to);
  return to.fingerprint();
}

TEST(Sharing, TellsWhatIsOneFromWhatIsAlike) {
  const Scene apart = test::painted_scene();
  Scene together = apart;
  together.parts[kBlock].mesh = together.parts[kCrate].mesh;
  EXPECT_NE(sharing_of(apart, {kCrate, kBlock}), sharing_of(together, {kCrate, kBlock}));
  EXPECT_EQ(sharing_of(apart, {kPane, kCrate}), sharing_of(together, {kPane, kCrate}));
  EXPECT_EQ(sharing_of(test::with_one_in_front(apart), {kCrate + 1, kBlock + 1}), sharing_of(apart, {kCrate, kBlock}));
}

}  // namespace
}  // namespace standin
