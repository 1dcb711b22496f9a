// What must hold for any scene: culling changes nothing, the world's origin does not matter, every device draws the same.
#include "render/device/mesh_buffers.h"
#include "tests/render/device/mixed_scene.h"

namespace standin::test {
namespace {

constexpr Camera kCamera{.fov_y_rad = 0.9, .width = 96, .height = 64, .near_m = 0.1};

class RendererPropertyTest : public DeviceTest {};

TEST_F(RendererPropertyTest, CullingNeverChangesThePicture) {
  std::uint64_t drawn_with_culling = 0;
  std::uint64_t drawn_without = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Scene scene = mixed_scene(seed, 80, 15.0);
    Renderer renderer(*context, scene, kCamera);
    Rng rng(seed, 1);
    for (int i = 0; i < 10; ++i) {
      const View view = random_view(rng, 10.0);
      drawn_with_culling += renderer.draw(view, everything(scene)).draws;
      const Texture culled = renderer.read_pixels();
      drawn_without += renderer.draw_projected(clip_from_eye(kCamera) * eye_from_world(view), view.position, everything(scene)).draws;
      ASSERT_EQ(culled.rgba, renderer.read_pixels().rgba) << "seed " << seed << ", view " << i;
    }
  }
  EXPECT_EQ(drawn_without, 3U * 10U * 80U);
  EXPECT_LT(drawn_with_culling, drawn_without / 2);
}

TEST_F(RendererPropertyTest, FarFromTheOriginThePictureIsTheSame) {
  const Vec3 offset(1.0e6, -2.0e5, 3.0e6);
  const Scene near_scene = mixed_scene(4, 80, 15.0);
  const Scene far_scene = mixed_scene(4, 80, 15.0, offset);
  Renderer near_renderer(*context, near_scene, kCamera);
  Renderer far_renderer(*context, far_scene, kCamera);
  Rng rng(5);
  std::size_t different = 0;
  for (int i = 0; i < 10; ++i) {
    View view = random_view(rng, 15.0);
    near_renderer.draw(view, everything(near_scene));
    view.position += offset;
    far_renderer.draw(view, everything(far_scene));
    different += count_different_pixels(near_renderer.read_pixels(), far_renderer.read_pixels());
  }
  // World doubles there are 5e-10 m apart; float ones 0.25 m, which would change most pixels.
  EXPECT_LE(different, 10U * 96U * 64U / 2000U);
}

TEST_F(RendererPropertyTest, AModelWithLargeCoordinatesOfItsOwnLosesNothing) {
  const glm::vec3 offset(1.0e6F, 4.0e5F, -3.0e6F);  // whole metres: the cube's corners stay exact in float
  Scene scene;
  add_object(scene, add_mesh(scene, make_cube()), add_material(scene, Material{}));
  update_derived(scene);
  View view{.position = Vec3(3.0, 2.0, 2.5), .direction = glm::normalize(Vec3(-3.0, -2.0, -2.5))};
  const Texture at_origin = draw(scene, view, kCamera);
  for (auto& position : scene.meshes[0].positions) position += offset;
  update_derived(scene);
  view.position += Vec3(offset);
  EXPECT_LE(count_different_pixels(at_origin, draw(scene, view, kCamera)), 2U);
  EXPECT_GT(count_drawn(at_origin), 300);
}

TEST_F(RendererPropertyTest, MeshesInSeveralBuffersAreDrawnAlike) {
  Scene scene = mixed_scene(6, 40, 10.0);
  const Texture before = draw(scene, {.position = Vec3(0.0, 0.0, 14.0)}, kCamera);
  Mesh filler;  // never drawn, but fills the first buffer before the cube comes
  filler.positions.assign(std::size_t{1} << 20, glm::vec3(0.0F));
  filler.normals.assign(filler.positions.size(), glm::vec3(0.0F, 1.0F, 0.0F));
  filler.indices = {0, 1, 2};
  scene.meshes.insert(scene.meshes.begin(), std::move(filler));
  for (auto& part : scene.parts) part.mesh = 1;
  update_derived(scene);
  EXPECT_EQ(before.rgba, draw(scene, {.position = Vec3(0.0, 0.0, 14.0)}, kCamera).rgba);
}

TEST_F(RendererPropertyTest, OsMesaAndEglDrawTheSamePixels) {
  const Scene scene = mixed_scene(7, 80, 12.0);
  const auto egl = make_context(DeviceKind::kEgl, 1, 1);
  Renderer egl_renderer(*egl, scene, kCamera);
  Rng rng(8);
  for (int i = 0; i < 4; ++i) {
    const View view = random_view(rng, 12.0);
    egl->make_current();
    const FrameCounts egl_counts = egl_renderer.draw(view, everything(scene));
    const Texture egl_image = egl_renderer.read_pixels();
    context->make_current();
    EXPECT_EQ(draw(scene, view, kCamera).rgba, egl_image.rgba) << "view " << i;
    EXPECT_EQ(counts, egl_counts);
  }
  egl->make_current();  // the renderer goes first
}

TEST_F(RendererPropertyTest, RenderersOfOneContextDoNotDisturbEachOther) {
  const Scene scene_a = mixed_scene(9, 40, 10.0);
  const Scene scene_b = mixed_scene(10, 40, 10.0);
  const View view{.position = Vec3(0.0, 0.0, 14.0)};
  const Texture alone_a = draw(scene_a, view, kCamera);
  Renderer a(*context, scene_a, kCamera);
  Renderer b(*context, scene_b, small_camera());
  for (int i = 0; i < 2; ++i) {
    a.draw(view, everything(scene_a));
    b.draw(view, everything(scene_b));
    EXPECT_EQ(a.read_pixels().rgba, alone_a.rgba);
  }
}

}  // namespace
}  // namespace standin::test
