// Pictures that can be reckoned by hand.
#include <glm/gtc/matrix_transform.hpp>

#include "render/base/error.h"
#include "render/scene/shading.h"
#include "tests/render/device/device_fixture.h"

namespace standin::test {
namespace {

class RendererTest : public DeviceTest {};

TEST_F(RendererTest, ARectangleCoversExactlyItsPixels) {
  Scene scene;
  add_object(scene, add_mesh(scene, make_rectangle(-3, -2, 5, 4, -8)), add_material(scene, unlit({1.0F, 0.0F, 0.0F, 1.0F})));
  update_derived(scene);
  const Texture image = draw(scene);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const bool inside = x >= 5 && x < 13 && y >= 4 && y < 10;
      const Rgba background = pixel(image, 0, 0);
      EXPECT_EQ(pixel(image, x, y), inside ? (Rgba{255, 0, 0, 255}) : background) << x << " " << y;
    }
  }
  EXPECT_NEAR(pixel(image, 0, 0)[0], 255 * 0.72, 1.0);
  EXPECT_NEAR(pixel(image, 0, 0)[1], 255 * 0.80, 1.0);
  EXPECT_NEAR(pixel(image, 0, 0)[2], 255 * 0.90, 1.0);
  EXPECT_EQ(pixel(image, 0, 0)[3], 0);
}

// A large rectangle whose second form is a small one.
TEST_F(RendererTest, AnObjectIsDrawnAtItsLevelOfDetail) {
  Scene scene;
  add_object(scene, add_mesh(scene, make_rectangle(-3, -2, 5, 4, -8)), add_material(scene, unlit({1.0F, 0.0F, 0.0F, 1.0F})));
  const std::uint32_t simple = add_mesh(scene, make_rectangle(-1, -1, 1, 1, -8));
  scene.objects[0].levels.push_back({static_cast<std::uint32_t>(scene.parts.size()), 1, 2, 0.0, -1.0, 100.0});
  scene.parts.push_back({simple, scene.parts[0].material});
  update_derived(scene);
  Renderer renderer(*context, scene, small_camera());
  const View ahead{Vec3(0.0), Vec3(0.0, 0.0, -1.0)};
  renderer.draw(ahead, {{0}, {}});
  EXPECT_EQ(count_drawn(renderer.read_pixels()), 48);
  renderer.draw(ahead, {{0}, {}, {1}});
  EXPECT_EQ(count_drawn(renderer.read_pixels()), 4);
  renderer.draw(ahead, {{0}, {}, {0}});
  EXPECT_EQ(count_drawn(renderer.read_pixels()), 48);
  EXPECT_THROW(renderer.draw(ahead, {{0}, {}, {2}}), Failure);
  EXPECT_THROW(renderer.draw(ahead, {{0}, {}, {0, 0}}), Failure);
}

// The plane's normal comes from its transformed corners, not from any matrix of normals.
TEST_F(RendererTest, ColourFollowsTheShadingRuleUnderAnyTransform) {
  const glm::vec4 colour(0.9F, 0.6F, 0.3F, 1.0F);
  Material lit;
  lit.base_colour = colour;
  const std::array<Mat4, 4> placements = {
      Mat4(1.0),
      glm::rotate(Mat4(1.0), 0.6, Vec3(1.0, 0.3, 0.0)),
      glm::rotate(Mat4(1.0), 0.7, Vec3(0.2, 1.0, 0.1)) * glm::scale(Mat4(1.0), Vec3(1.0, 7.0, 0.2)) *
          glm::rotate(Mat4(1.0), 0.5, Vec3(0.0, 1.0, 1.0)),
      glm::scale(Mat4(1.0), Vec3(-1.0, 1.0, 1e-6)) * glm::rotate(Mat4(1.0), -0.4, Vec3(1.0, 1.0, 0.0)),
  };
  for (std::size_t i = 0; i < placements.size(); ++i) {
    Scene scene;
    const Mat4 placement = translation({0.0, 0.0, -8.0}) * placements[i];
    add_object(scene, add_mesh(scene, make_rectangle(-20, -20, 20, 20, 0)), add_material(scene, lit), placement);
    update_derived(scene);
    const Vec3 normal = glm::normalize(glm::cross(Vec3(placement[0]), Vec3(placement[1])));
    const double brightness = kAmbient + kDiffuse * std::abs(glm::dot(normal, light_direction()));
    const Rgba shown = pixel(draw(scene), 8, 8);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(shown[channel], 255 * colour[channel] * brightness, 1.0) << i;
    EXPECT_EQ(shown[3], 255);
  }
}

TEST_F(RendererTest, ATextureStandsUprightAndIsExactAtItsOwnSize) {
  Scene scene;
  scene.textures.push_back(make_texture(8, 4, [](int x, int y) {
    return std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(30 * x), static_cast<std::uint8_t>(60 * y), 7, 255};
  }));
  Material material = unlit(glm::vec4(1.0F));
  material.texture = 0;
  add_object(scene, add_mesh(scene, make_rectangle(-4, -2, 4, 2, -8)), add_material(scene, material));
  update_derived(scene);
  const Texture image = draw(scene);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) EXPECT_EQ(pixel(image, 4 + x, 6 + y), (Rgba{30 * x, 60 * y, 7, 255})) << x << " " << y;
}

TEST_F(RendererTest, ATextureRepeatsAndFarAwayShowsItsMean) {
  Scene scene;
  scene.textures.push_back(make_texture(64, 64, [](int x, int y) {
    const std::uint8_t value = (x + y) % 2 == 0 ? 200 : 100;
    return std::array<std::uint8_t, 4>{value, value, value, 255};
  }));
  Material material = unlit(glm::vec4(1.0F));
  material.texture = 0;
  Mesh mesh = make_rectangle(-8, -8, 8, 8, -8);
  for (auto& uv : mesh.uvs) uv = uv * 8.0F - 3.0F;  // 8 repeats over 16 pixels
  add_object(scene, add_mesh(scene, std::move(mesh)), add_material(scene, material));
  update_derived(scene);
  const Texture image = draw(scene);
  for (int x = 0; x < 16; ++x) EXPECT_NEAR(pixel(image, x, 5)[0], 150, 1);
}

TEST_F(RendererTest, AMaskKeepsAlphaAtAndAboveTheCutoff) {
  Scene scene;
  scene.textures.push_back(make_texture(8, 8, [](int x, int) {
    return std::array<std::uint8_t, 4>{255, 255, 255, static_cast<std::uint8_t>(x % 2 == 0 ? 255 : 254)};
  }));
  Material material = unlit({1.0F, 1.0F, 1.0F, 0.5F});
  material.texture = 0;
  material.alpha_mode = AlphaMode::kMask;
  material.alpha_cutoff = 0.5F;
  add_object(scene, add_mesh(scene, make_rectangle(-4, -4, 4, 4, -8)), add_material(scene, material));
  add_object(scene, add_mesh(scene, make_rectangle(-4, -4, 4, 4, -16)), add_material(scene, unlit({0.0F, 1.0F, 0.0F, 1.0F})));
  update_derived(scene);
  const Texture image = draw(scene);
  // The rectangle behind is seen through every second column, half as wide: columns 6 to 9.
  for (int x = 4; x < 12; ++x) EXPECT_EQ(drawn(image, x, 4), x % 2 == 0) << x;
  for (int x = 6; x < 10; ++x) EXPECT_EQ(pixel(image, x, 8), x % 2 == 0 ? kOpaqueWhite : (Rgba{0, 255, 0, 255})) << x;
}

TEST_F(RendererTest, AMaskWithoutATextureDrawsAllOrNothing) {
  Scene scene;
  Material material = unlit({1.0F, 1.0F, 1.0F, 0.4F});
  material.alpha_mode = AlphaMode::kMask;
  const auto mesh = add_mesh(scene, make_rectangle(-4, -4, 4, 4, -8));
  add_object(scene, mesh, add_material(scene, material));
  update_derived(scene);
  EXPECT_EQ(count_drawn(draw(scene)), 0);
  EXPECT_EQ(counts.draws, 0U);
  scene.materials[0].alpha_cutoff = 0.4F;
  EXPECT_EQ(count_drawn(draw(scene)), 64);
  scene.materials[0].alpha_mode = AlphaMode::kOpaque;  // alpha does not matter then
  scene.materials[0].alpha_cutoff = 0.9F;
  EXPECT_EQ(count_drawn(draw(scene)), 64);
}

TEST_F(RendererTest, BackFacesAreDroppedUnlessDoubleSided) {
  Scene scene;
  add_object(scene, add_mesh(scene, make_rectangle(-4, -4, 4, 4, 0)), add_material(scene, unlit(glm::vec4(1.0F))));
  const Mat4 turned = glm::rotate(Mat4(1.0), std::numbers::pi, Vec3(0.0, 1.0, 0.0));
  const Mat4 mirrored = glm::scale(Mat4(1.0), Vec3(-1.0, 1.0, 1.0));  // still faces +z, though its corners run the other way round
  const auto drawn_as = [&](const Mat4& placement, bool double_sided) {
    scene.materials[0].double_sided = double_sided;
    scene.objects[0].world_from_object = translation({0.0, 0.0, -8.0}) * placement;
    update_derived(scene);
    return count_drawn(draw(scene));
  };
  for (const Mat4& facing : {Mat4(1.0), mirrored}) {
    EXPECT_EQ(drawn_as(facing, false), 64);
    EXPECT_EQ(drawn_as(turned * facing, false), 0);
    EXPECT_EQ(drawn_as(turned * facing, true), 64);
  }
}

TEST_F(RendererTest, NearerHidesFartherInAnyOrderAndFarAway) {
  for (const double distance_m : {8.0, 1000.0, 30000.0}) {
    for (const bool nearer_first : {false, true}) {
      Scene scene;
      const auto mesh = add_mesh(scene, make_rectangle(-1, -1, 1, 1, 0));
      const Mat4 size = glm::scale(Mat4(1.0), Vec3(distance_m, distance_m, 1.0));
      const auto red = add_material(scene, unlit({1.0F, 0.0F, 0.0F, 1.0F}));
      const auto green = add_material(scene, unlit({0.0F, 1.0F, 0.0F, 1.0F}));
      add_object(scene, mesh, nearer_first ? red : green, translation({0.0, 0.0, -distance_m}) * size);
      add_object(scene, mesh, nearer_first ? green : red, translation({0.0, 0.0, -distance_m * 1.00001}) * size);
      update_derived(scene);
      EXPECT_EQ(pixel(draw(scene), 8, 8), nearer_first ? (Rgba{255, 0, 0, 255}) : (Rgba{0, 255, 0, 255})) << distance_m;
    }
  }
}

TEST_F(RendererTest, NothingNearerThanTheNearPlaneIsDrawn) {
  Scene scene;
  add_object(scene, add_mesh(scene, make_rectangle(-4, -4, 4, 4, -8)), add_material(scene, unlit(glm::vec4(1.0F))));
  update_derived(scene);
  Camera camera = small_camera();
  camera.near_m = 7.99;
  EXPECT_EQ(count_drawn(draw(scene, {}, camera)), 64);
  camera.near_m = 8.01;
  EXPECT_EQ(count_drawn(draw(scene, {}, camera)), 0);
}

TEST_F(RendererTest, CountsAreExact) {
  Scene scene;
  scene.textures.assign(2, make_texture(1, 1, [](int, int) { return std::array<std::uint8_t, 4>{9, 9, 9, 255}; }));
  const auto plain = add_material(scene, unlit(glm::vec4(1.0F)));
  std::array<std::uint32_t, 2> textured{};
  for (int i = 0; i < 2; ++i) {
    Material material;
    material.texture = i;
    textured[static_cast<std::size_t>(i)] = add_material(scene, material);
  }
  const auto rectangle = add_mesh(scene, make_rectangle(-1, -1, 1, 1, 0));
  const auto cube = add_mesh(scene, make_cube());
  // Distances 9 to 14: one octave. Order: plain, texture 0 twice, texture 1 twice.
  add_object(scene, cube, textured[0], translation({0, 0, -9}));
  add_object(scene, cube, textured[1], translation({0, 0, -10}));
  add_object(scene, rectangle, textured[0], translation({0, 0, -11}));
  add_object(scene, rectangle, plain, translation({0, 0, -12}));
  add_object(scene, rectangle, textured[1], translation({0, 0, -14}));
  add_object(scene, cube, textured[1], translation({0, 0, 20}));  // behind the eye
  update_derived(scene);
  draw(scene);
  EXPECT_EQ(counts, (FrameCounts{.draws = 5, .triangles = 30, .texture_switches = 2, .program_switches = 2, .impostor_draws = 0}));
  scene.objects[1].world_from_object = translation({0, 0, -30});  // an octave of its own
  scene.objects[4].world_from_object = translation({0, 0, -31.5});
  scene.objects[3].world_from_object = translation({0, 0, -32.5});
  update_derived(scene);
  draw(scene);
  EXPECT_EQ(counts.texture_switches, 2U);
  EXPECT_EQ(counts.program_switches, 2U);
}

TEST_F(RendererTest, AnObjectOfSeveralPartsIsSeveralDraws) {
  Scene scene;
  const auto material = add_material(scene, unlit(glm::vec4(1.0F)));
  add_object(scene, add_mesh(scene, make_rectangle(-4, -4, 0, 4, -8)), material);
  scene.parts.push_back({.mesh = add_mesh(scene, make_rectangle(2, -4, 4, 4, -8)), .material = material});
  scene.objects[0].part_count = 2;
  update_derived(scene);
  EXPECT_EQ(count_drawn(draw(scene)), 32 + 16);
  EXPECT_EQ(counts.draws, 2U);
  EXPECT_EQ(counts.triangles, 4U);
}

TEST_F(RendererTest, PassedPixelsLeaveHiddenOnesOut) {
  Scene scene;
  const auto mesh = add_mesh(scene, make_rectangle(-3, -2, 5, 4, 0));
  const auto material = add_material(scene, unlit(glm::vec4(1.0F)));
  add_object(scene, mesh, material, translation({0, 0, -33}));  // drawn second, all but hidden
  add_object(scene, mesh, material, translation({0, 0, -8}));
  update_derived(scene);
  Renderer renderer(*context, scene, small_camera());
  EXPECT_EQ(renderer.count_passed_pixels({}, {.objects = {1}, .impostors = {}}), 48U);
  EXPECT_EQ(renderer.count_passed_pixels({}, everything(scene)), 48U);
  EXPECT_EQ(renderer.count_passed_pixels({}, {}), 0U);
}

TEST_F(RendererTest, UnknownIdsAreInternalFailures) {
  Scene scene;
  update_derived(scene);
  Renderer renderer(*context, scene, small_camera());
  for (const DrawList& list : {DrawList{.objects = {0}, .impostors = {}}, DrawList{.objects = {}, .impostors = {0}}}) {
    try {
      renderer.draw({}, list);
      ADD_FAILURE();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kInternal);
    }
  }
}

TEST_F(RendererTest, ATextureTooLargeForTheDeviceIsNamed) {
  Scene scene;
  scene.textures.push_back({.name = "poster", .width = 1 << 20, .height = 1, .rgba = {}});
  try {
    const Renderer renderer(*context, scene, small_camera());
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kDeviceUnavailable);
    EXPECT_NE(std::string(failure.what()).find("poster"), std::string::npos);
  }
}

}  // namespace
}  // namespace standin::test
