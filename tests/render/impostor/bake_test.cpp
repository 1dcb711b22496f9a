// Plans and bakes from requests: what is possible, why not, and that the result depends on nothing but the request.
#include "render/impostor/bake.h"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "render/base/error.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin {
namespace {

using test::rectangle;
using test::SmallScene;

ViewCell shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

Scene wall_scene() {
  SmallScene scene;
  scene.add_object(rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  return std::move(scene.scene);
}

TEST(Plan, AWallFacingTheCellNeedsOneLayer) {
  const Camera camera;
  const ImpostorPlan plan = plan_impostor({Vec3(-1, -1, 0), Vec3(1, 1, 0)}, shaft_towards_z(0.2, 10.0), camera, {});
  ASSERT_TRUE(plan.possible) << plan.why_not;
  EXPECT_EQ(plan.layers.size(), 1U);
  EXPECT_EQ(plan.frame.forward, Vec3(0, 0, -1));
  const double texels_at_nearest_point = 2.0 / 10.0 * camera.focal_px();  // 2 m wide, seen from 10 m
  EXPECT_EQ(plan.frame.width, static_cast<std::uint32_t>(std::ceil(texels_at_nearest_point)));
  const double depth = glm::dot(-plan.frame.reference_viewpoint, plan.frame.forward);
  EXPECT_NEAR(plan.layers[0].distance_m, depth, 1e-9);
}

TEST(Plan, TexelsAreNeverMagnified) {
  Rng rng(1);
  const Camera camera;
  for (int i = 0; i < 200; ++i) {
    const Box object{Vec3(-1, -2, -3), Vec3(2, 1, rng.uniform(0.0, 4.0))};
    const ViewCell cell = i % 2 == 0 ? shaft_towards_z(rng.uniform(0.01, 0.5), rng.uniform(5.0, 60.0))
                                     : ViewCell(Box{Vec3(-1, -1, rng.uniform(6.0, 40.0)), Vec3(1, 1, 60.0)});
    const ImpostorPlan plan = plan_impostor(object, cell, camera, {});
    if (!plan.possible) continue;
    const double near_border = std::holds_alternative<Box>(cell) ? std::get<Box>(cell).min.z : std::get<Shaft>(cell).min_distance_m;
    const double s = plan.frame.reference_viewpoint.z - near_border;
    for (const Layer& layer : plan.layers)
      EXPECT_LE(plan.frame.slope_step.x * layer.distance_m / (layer.distance_m - s), 1.0 / camera.focal_px() + 1e-12);
  }
}

TEST(Plan, TheTextureHoldsTheWholeObjectAndLittleElse) {
  for (const double x : {0.0, 7.0, -12.0}) {
    const Box object{Vec3(x - 1, -2, -3), Vec3(x + 2, 1, 1)};
    const ImpostorPlan plan = plan_impostor(object, Box{Vec3(-2, -1, 20), Vec3(2, 1, 24)}, Camera{}, {});
    ASSERT_TRUE(plan.possible) << plan.why_not;
    Vec2 low(1e9), high(-1e9);
    for (int i = 0; i < 8; ++i) {
      const Vec3 offset = object.corner(i) - plan.frame.reference_viewpoint;
      const Vec2 slope = Vec2(glm::dot(offset, plan.frame.right), glm::dot(offset, plan.frame.up)) / glm::dot(offset, plan.frame.forward);
      low = glm::min(low, slope);
      high = glm::max(high, slope);
    }
    const double left = plan.frame.slope_min.x, right = left + plan.frame.width * plan.frame.slope_step.x;
    EXPECT_LE(left, low.x + 1e-12);
    EXPECT_GE(right, high.x - 1e-12);
    EXPECT_LT(right - left, high.x - low.x + 1.001 * plan.frame.slope_step.x);
    EXPECT_GE(plan.frame.slope_min.y, high.y - 1e-12);
    EXPECT_LE(plan.frame.slope_min.y - plan.frame.height * plan.frame.slope_step.y, low.y + 1e-12);
  }
}

TEST(Plan, SaysWhyNot) {
  const Box object{Vec3(-1), Vec3(1)};
  const auto why_not = [&](const ViewCell& cell, const BakeQuality& quality = {}) {
    return std::string(plan_impostor(object, cell, Camera{}, quality).why_not);
  };
  EXPECT_EQ(why_not(shaft_towards_z(0.2, 1.0)), "cluster reaches into the view cell");
  EXPECT_EQ(why_not(Box{Vec3(-2, -2, 0.5), Vec3(2, 2, 5)}), "cluster reaches into the view cell");
  EXPECT_EQ(why_not(Box{Vec3(-5), Vec3(5)}), "cluster reaches into the view cell");
  EXPECT_EQ(why_not(shaft_towards_z(0.8, 1.5), {.max_layers = 5}), "too many layers");
  EXPECT_EQ(why_not(shaft_towards_z(0.2, 1.01)), "texture too large");
  EXPECT_EQ(why_not(shaft_towards_z(0.2, 10.0)), "");
  EXPECT_FALSE(plan_impostor(Box{}, shaft_towards_z(0.2, 10.0), Camera{}, {}).possible);
}

TEST(Plan, BoxesAreSeenAlongAnAxisOnWhichTheClusterLiesBeyondThem) {
  const Box object{Vec3(-1), Vec3(1)};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3 centre(0.0);
      centre[axis] = 20.0 * sign;
      const ImpostorPlan plan = plan_impostor(object, Box{centre - Vec3(1.0), centre + Vec3(1.0)}, Camera{}, {});
      ASSERT_TRUE(plan.possible);
      EXPECT_EQ(plan.frame.forward[axis], -sign);
      EXPECT_EQ(glm::cross(plan.frame.right, plan.frame.up), -plan.frame.forward);
    }
}

TEST(Sketch, ForetellsThePlan) {
  Rng rng(2);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const Box object{Vec3(-2, -1, -3), Vec3(rng.uniform(-1.0, 5.0), rng.uniform(0.0, 4.0), 2)};
    const ViewCell cell = i % 2 == 0 ? shaft_towards_z(rng.uniform(0.01, 0.5), rng.uniform(3.0, 60.0))
                                     : ViewCell(Box{Vec3(-5, -1, rng.uniform(3.0, 40.0)), Vec3(-2, 1, 60.0)});
    const BakeQuality quality{.max_layers = 100000};
    const ImpostorPlan plan = plan_impostor(object, cell, Camera{}, quality);
    const ImpostorSketch sketch = sketch_impostor(object, cell, Camera{}, quality);
    ASSERT_EQ(plan.possible, std::isfinite(sketch.layers)) << plan.why_not;
    if (!plan.possible) continue;
    ++compared;
    const auto layers = static_cast<double>(plan.layers.size());
    EXPECT_NEAR(sketch.layers, layers, 2.0 + 0.03 * layers);
    EXPECT_EQ(sketch.width_texels, plan.frame.width);
    EXPECT_EQ(sketch.height_texels, plan.frame.height);
    EXPECT_NEAR(sketch.distance_m, glm::length(object.centre() - plan.frame.reference_viewpoint), 1e-9);
  }
  EXPECT_GT(compared, 200);
  EXPECT_TRUE(std::isinf(sketch_impostor({Vec3(-1), Vec3(1)}, shaft_towards_z(0.2, 1.0), Camera{}, {}).layers));
}

TEST(Sketch, OfPointsForetellsThePlanOfPoints) {
  Rng rng(4);
  const BakeQuality quality{.max_layers = 100000};
  for (int i = 0; i < 100; ++i) {
    std::vector<Vec3> points;
    Box bounds;
    for (int k = 0; k < 12; ++k) {
      points.emplace_back(rng.uniform(-3.0, 3.0), rng.uniform(-1.0, 2.0), rng.uniform(-4.0, 1.0));
      bounds.extend(points.back());
    }
    const ViewCell cell = i % 2 == 0 ? shaft_towards_z(rng.uniform(0.01, 0.3), rng.uniform(8.0, 60.0))
                                     : ViewCell(Box{Vec3(-5, -1, rng.uniform(5.0, 40.0)), Vec3(-2, 1, 60.0)});
    const ImpostorPlan plan = plan_impostor(bounds, points, cell, Camera{}, quality);
    const ImpostorSketch sketch = sketch_impostor(bounds, points, cell, Camera{}, quality);
    ASSERT_TRUE(plan.possible);
    EXPECT_EQ(sketch.width_texels, plan.frame.width);
    EXPECT_EQ(sketch.height_texels, plan.frame.height);
    EXPECT_EQ(sketch.frame.slope_step, plan.frame.slope_step);
    EXPECT_NEAR(sketch.layers, static_cast<double>(plan.layers.size()), 2.0 + 0.03 * sketch.layers);
    EXPECT_NEAR(sketch.near_m, plan.layers.front().near_m, 1e-9);
    EXPECT_NEAR(sketch.far_m, plan.layers.back().far_m, 1e-9);
  }
}

TEST(Bake, AWallIsOneFullQuad) {
  const Impostor impostor = bake_layered(wall_scene(), {{0}, shaft_towards_z(0.2, 10.0)}, Camera{}, {});
  ASSERT_EQ(impostor.layers.size(), 1U);
  ASSERT_EQ(impostor.quads.size(), 1U);
  EXPECT_EQ(impostor.quads[0].width, impostor.frame.width);
  EXPECT_EQ(impostor.quads[0].height, impostor.frame.height);
  for (const std::uint8_t byte : impostor.texels) EXPECT_EQ(byte, 255);  // white, unlit, opaque
}

TEST(Bake, WallsHiddenBehindAWallAreCulled) {
  SmallScene scene;
  scene.add_object(rectangle({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}));
  scene.add_object(rectangle({-1, -1, -6}, {2, 0, 0}, {0, 2, 0}));
  const Impostor impostor = bake_layered(scene.scene, {{0, 1}, shaft_towards_z(0.1, 20.0)}, Camera{}, {});
  EXPECT_GT(impostor.layers.size(), 5U);
  for (const Quad& quad : impostor.quads) EXPECT_EQ(quad.layer, 0U);
}

TEST(Bake, SmallAndThinThingsSurvive) {
  SmallScene scene;
  const auto speck = scene.add_object(rectangle({0.3, 0.2, 0}, {0.01, 0, 0}, {0, 0.01, 0}));
  const auto wire = scene.add_object(rectangle({-2, 0.1, 0}, {4, 0, 0}, {0, 1e-5, 0}));
  const auto edge_on = scene.add_object(rectangle({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}));
  const ViewCell cell = shaft_towards_z(0.1, 40.0);
  const Impostor one = bake_layered(scene.scene, {{speck}, cell}, Camera{}, {});
  EXPECT_EQ(one.frame.width, 1U);
  EXPECT_EQ(one.frame.height, 1U);
  EXPECT_EQ(one.texel_count(), 1U);
  for (const std::uint32_t id : {wire, edge_on}) {
    const Impostor impostor = bake_layered(scene.scene, {{id}, cell}, Camera{}, {.seal_rims = false});
    const test::DrawnImpostor drawn(impostor);
    std::uint32_t filled_columns = 0;
    for (std::uint32_t x = 0; x < impostor.frame.width; ++x) {
      bool any = false;
      for (std::size_t layer = 0; layer < impostor.layers.size(); ++layer)
        for (std::uint32_t y = 0; y < impostor.frame.height; ++y) any = any || drawn.texel(layer, x, y)[3] != 0;
      filled_columns += any;
    }
    EXPECT_EQ(filled_columns, impostor.frame.width) << "object " << id;
  }
}

TEST(Bake, NoTexelIsShownTwice) {
  Rng rng(3);
  SmallScene scene;
  scene.add_object(test::random_triangles(rng, {Vec3(-4, -3, -5), Vec3(4, 3, 5)}, 60));
  const Impostor impostor = bake_layered(scene.scene, {{0}, shaft_towards_z(0.2, 20.0)}, Camera{}, {});
  EXPECT_EQ(test::DrawnImpostor(impostor).duplicates(), 0);
}

TEST(Bake, IsTheSameOnAnyThread) {
  Rng rng(4);
  SmallScene scene;
  Material material;
  material.texture = 0;
  material.alpha_mode = AlphaMode::kMask;
  Texture texture{"noise", 32, 32, {}};
  for (int i = 0; i < 32 * 32 * 4; ++i) texture.rgba.push_back(static_cast<std::uint8_t>(rng.below(256)));
  scene.scene.textures.push_back(texture);
  std::vector<std::array<Vec2, 3>> uvs(50, {Vec2(0.0), Vec2(3.0, 0.0), Vec2(0.0, 3.0)});
  scene.add_object(test::random_triangles(rng, {Vec3(-4, -3, -5), Vec3(4, 3, 5)}, 50), material, uvs);
  const TexturePyramids textures(scene.scene);
  std::array<Impostor, 3> results;
  std::vector<std::thread> threads;
  for (Impostor& result : results)
    threads.emplace_back([&] { result = bake_layered(scene.scene, textures, {{0}, shaft_towards_z(0.2, 20.0)}, Camera{}, {}); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_FALSE(results[0].texels.empty());
  for (const Impostor& result : results) EXPECT_EQ(result.texels, results[0].texels);
}

ErrorWord word_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Failure& failure) {
    return failure.word();
  }
  return ErrorWord::kInternal;
}

TEST(Bake, RefusesWhatCannotBe) {
  const Scene scene = wall_scene();
  EXPECT_EQ(word_of([&] { (void)bake_layered(scene, {{0}, shaft_towards_z(0.2, 0.0)}, Camera{}, {}); }), ErrorWord::kImpostorImpossible);
  EXPECT_EQ(word_of([&] { (void)bake_layered(scene, {{}, shaft_towards_z(0.2, 10.0)}, Camera{}, {}); }), ErrorWord::kBadUsage);
  EXPECT_EQ(word_of([&] { (void)bake_layered(scene, {{7}, shaft_towards_z(0.2, 10.0)}, Camera{}, {}); }), ErrorWord::kBadUsage);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(word_of([&] {
              (void)bake_layered(scene, {{0}, shaft_towards_z(0.2, 10.0)}, Camera{}, {}, WorkBudget(&stop));
            }),
            ErrorWord::kCancelled);
}

// A wall (one layer) and a deep, half untextured cluster: doing what could be left out changes no byte.
TEST(Bake, LeavesOutOnlyWhatCannotBeSeen) {
  for (const double depth : {0.0, 8.0}) {
    SmallScene scene;
    scene.scene.textures.push_back({"dark", 1, 1, {90, 60, 30, 255}});
    Material textured = SmallScene::white(), lit;
    textured.texture = 0;
    lit.base_colour = glm::vec4(0.5F, 0.7F, 0.3F, 1.0F);
    scene.add_object(rectangle({-1, -1, -depth}, {1, 0, 0.4 * depth}, {0, 2, 0}), textured, test::rectangle_uvs());
    scene.add_object(rectangle({0, -1, 0}, {1, 0, -depth}, {0, 2, 0}), lit);
    scene.add_object(rectangle({-0.5, -0.5, -depth}, {1, 0, 0}, {0, 1, 0}), SmallScene::white());
    const BakeRequest request{{0, 1, 2}, shaft_towards_z(0.2, 10.0)};
    BakeQuality quality;
    const Impostor normal = bake_layered(scene.scene, request, {}, quality);
    quality.leave_out = false;
    const Impostor forced = bake_layered(scene.scene, request, {}, quality);
    EXPECT_EQ(normal.layers.size() == 1, depth == 0.0);
    EXPECT_EQ(normal.texels, forced.texels);
    EXPECT_EQ(normal.quads.size(), forced.quads.size());
  }
}

}  // namespace
}  // namespace standin
