// Impostors seen from their reference viewpoint show their texels; tests/support/gl_layers.h records what they should hold.
#include "render/base/error.h"
#include "tests/render/device/device_fixture.h"
#include "tests/support/gl_layers.h"

namespace standin::test {
namespace {

const Vec3 kViewpoint(1000.0, 20.0, -300.0);

// Texels are the pixels of small_camera() at kViewpoint.
ImpostorFrame pixel_frame() {
  ImpostorFrame frame;
  frame.reference_viewpoint = kViewpoint;
  frame.slope_min = {-1.0, 1.0};
  frame.slope_step = {0.125, 0.125};
  frame.width = 16;
  frame.height = 16;
  return frame;
}

constexpr Quad kQuads[] = {{.layer = 0, .x = 3, .y = 2, .width = 4, .height = 5}, {.layer = 1, .x = 9, .y = 4, .width = 6, .height = 3}};
constexpr AtlasSlot kSlots[] = {{.page = 1, .x = 5, .y = 1}, {.page = 0, .x = 1, .y = 2}};

// Colours tell pages and texels apart; every fifth texel is transparent.
Texture make_page(std::uint8_t number) {
  return make_texture(20, 12, [&](int x, int y) {
    return std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(10 * x), static_cast<std::uint8_t>(20 * y), number,
                                       static_cast<std::uint8_t>((x + 2 * y) % 5 == 0 ? 0 : 255)};
  });
}

ImpostorSet two_quads() {
  Impostor impostor;
  impostor.frame = pixel_frame();
  impostor.layers = {{.distance_m = 8.0, .near_m = 7.0, .far_m = 9.0}, {.distance_m = 12.0, .near_m = 9.0, .far_m = 15.0}};
  impostor.quads.assign(std::begin(kQuads), std::end(kQuads));
  return {.impostors = {impostor}, .slots = {{std::begin(kSlots), std::end(kSlots)}}, .pages = {make_page(50), make_page(100)}};
}

/// Colour of the texel of `set` at texel coordinates (x, y) of the frame; alpha 0 outside the quads.
Rgba expected_texel(const ImpostorSet& set, int x, int y) {
  for (std::size_t i = 0; i < std::size(kQuads); ++i) {
    const int column = x - static_cast<int>(kQuads[i].x);
    const int row = y - static_cast<int>(kQuads[i].y);
    if (column < 0 || row < 0 || column >= static_cast<int>(kQuads[i].width) || row >= static_cast<int>(kQuads[i].height)) continue;
    return pixel(set.pages[kSlots[i].page], static_cast<int>(kSlots[i].x) + column, static_cast<int>(kSlots[i].y) + row);
  }
  return {0, 0, 0, 0};
}

class ImpostorDrawingTest : public DeviceTest {
 protected:
  Scene empty;
  const DrawList first{.objects = {}, .impostors = {0}};
};

TEST_F(ImpostorDrawingTest, FromTheReferenceViewpointEveryTexelIsAPixel) {
  const ImpostorSet set = two_quads();
  Renderer renderer(*context, empty, small_camera());
  renderer.upload(set);
  const FrameCounts frame = renderer.draw({.position = kViewpoint}, first);
  EXPECT_EQ(frame, (FrameCounts{.draws = 2, .triangles = 4, .texture_switches = 2, .program_switches = 1, .impostor_draws = 2}));
  const Texture image = renderer.read_pixels();
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const Rgba texel = expected_texel(set, x, y);
      EXPECT_EQ(drawn(image, x, y), texel[3] == 255) << x << " " << y;
      if (texel[3] == 255) {
        EXPECT_EQ(pixel(image, x, y), texel) << x << " " << y;
      }
    }
  }
}

TEST_F(ImpostorDrawingTest, FromHalfTheDistanceATexelIsFourPixels) {
  ImpostorSet set = two_quads();
  set.impostors[0].quads = {{.layer = 0, .x = 6, .y = 6, .width = 4, .height = 4}};
  set.slots[0] = {{.page = 0, .x = 2, .y = 3}};
  Renderer renderer(*context, empty, small_camera());
  renderer.upload(set);
  renderer.draw({.position = kViewpoint + Vec3(0.0, 0.0, -4.0)}, first);
  const Texture image = renderer.read_pixels();
  for (int y = 4; y < 12; ++y) {
    for (int x = 4; x < 12; ++x) {
      const Rgba texel = pixel(set.pages[0], 2 + (x - 4) / 2, 3 + (y - 4) / 2);
      if (texel[3] == 255) {
        EXPECT_EQ(pixel(image, x, y), texel) << x << " " << y;
      }
      EXPECT_EQ(drawn(image, x, y), texel[3] == 255) << x << " " << y;
    }
  }
}

TEST_F(ImpostorDrawingTest, ObjectsAndImpostorsHideEachOther) {
  Scene scene;
  const auto mesh = add_mesh(scene, make_rectangle(-20, -20, 20, 20, 0));
  const auto material = add_material(scene, unlit(glm::vec4(1.0F)));
  const auto in_front = add_object(scene, mesh, material, translation(kViewpoint + Vec3(0, 0, -7)));
  const auto behind = add_object(scene, mesh, material, translation(kViewpoint + Vec3(0, 0, -13)));
  update_derived(scene);
  const ImpostorSet set = two_quads();
  Renderer renderer(*context, scene, small_camera());
  renderer.upload(set);
  renderer.draw({.position = kViewpoint}, {.objects = {in_front}, .impostors = {0}});
  EXPECT_EQ(pixel(renderer.read_pixels(), 4, 3), kOpaqueWhite);
  renderer.draw({.position = kViewpoint}, {.objects = {behind}, .impostors = {0}});
  const Texture image = renderer.read_pixels();
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const Rgba texel = expected_texel(set, x, y);
      EXPECT_EQ(pixel(image, x, y), texel[3] == 255 ? texel : kOpaqueWhite) << x << " " << y;
    }
  }
}

TEST_F(ImpostorDrawingTest, DrawsAreSortedByPageAndCulled) {
  ImpostorSet set = two_quads();
  for (int i = 0; i < 3; ++i) {
    set.impostors.push_back(set.impostors[0]);
    set.slots.push_back(set.slots[0]);
  }
  set.impostors[2].frame.reference_viewpoint += Vec3(1e4, 0.0, 0.0);  // out of sight
  set.impostors[3].quads.clear();
  set.slots[3].clear();
  Renderer renderer(*context, empty, small_camera());
  renderer.upload(set);
  const FrameCounts frame = renderer.draw({.position = kViewpoint}, {.objects = {}, .impostors = {0, 1, 2, 3}});
  EXPECT_EQ(frame, (FrameCounts{.draws = 4, .triangles = 8, .texture_switches = 2, .program_switches = 1, .impostor_draws = 4}));
}

TEST_F(ImpostorDrawingTest, UploadReplacesTheSet) {
  Renderer renderer(*context, empty, small_camera());
  renderer.upload(two_quads());
  renderer.upload(ImpostorSet{});
  EXPECT_THROW(renderer.draw({.position = kViewpoint}, first), Failure);
}

TEST_F(ImpostorDrawingTest, TheLayerOracleShowsOnlyItsDepthRange) {
  Scene scene;
  add_object(scene, add_mesh(scene, make_rectangle(-3, -2, 5, 4, -8)), add_material(scene, unlit({1.0F, 0.0F, 0.0F, 1.0F})),
             translation(kViewpoint));
  add_object(scene, add_mesh(scene, make_rectangle(-6, -6, 6, 6, -12)), add_material(scene, unlit({0.0F, 1.0F, 0.0F, 1.0F})),
             translation(kViewpoint));
  update_derived(scene);
  const double infinity = std::numeric_limits<double>::infinity();
  ImpostorFrame frame = pixel_frame();  // columns 2 to 15 and rows 1 to 12 of the whole picture: off-axis
  frame.slope_min += Vec2(2 * 0.125, -1 * 0.125);
  frame.width = 14;
  frame.height = 12;
  const std::vector<Layer> layers = {{.distance_m = 8, .near_m = 7, .far_m = 9}, {.distance_m = 12, .near_m = 9, .far_m = infinity}};
  const auto textures = draw_layers(*context, scene, {0, 1}, frame, layers);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 14; ++x) {
      const bool in_red = x >= 3 && x < 11 && y >= 3 && y < 9;
      const bool in_green = x >= 2 && x < 10 && y >= 3 && y < 11;
      EXPECT_EQ(drawn(textures[0], x, y), in_red) << x << " " << y;
      EXPECT_EQ(drawn(textures[1], x, y), in_green) << x << " " << y;
    }
  }
  EXPECT_EQ(pixel(textures[0], 5, 5), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(pixel(textures[1], 5, 5), (Rgba{0, 255, 0, 255}));
}

}  // namespace
}  // namespace standin::test
