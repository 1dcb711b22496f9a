#include "placement/candidates/size_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "render/impostor/texture_pyramid.h"
#include "tests/placement/candidates/toy_world.h"
#include "tests/support/scene_builder.h"

namespace standin::test {
namespace {

SizeInput input_of(double silhouette_texels, double layers, double crossed = 1.0, double cut_texels = 0.0) {
  return {silhouette_texels, 1.1 * silhouette_texels, layers, crossed, cut_texels};
}

SizeSample sample_of(const SizeModel& truth, const SizeInput& input, double noise = 1.0) {
  SizeEstimate size = estimate_size(truth, input);
  size.bytes *= noise;
  return {input, size};
}

SizeInput random_input(Rng& rng) {
  const double layers = std::exp(rng.uniform(0.0, 5.0));
  return input_of(std::exp(rng.uniform(5.0, 12.0)), layers, std::exp(rng.uniform(0.0, std::log(layers))), std::exp(rng.uniform(0.0, 9.0)));
}

/// Each with another power law than the default's.
SizeModel some_truth() {
  SizeModel truth;
  truth.log_bytes = {1.7, 0.8, 0.6, 0.1, 0.3};
  truth.log_texels = {0.1, 0.9, 0.5, 0.2, 0.2};
  truth.log_quads = {0.5, 0.2, 1.1, 0.3, 0.0};
  return truth;
}

TEST(SizeModel, FitFindsTheLawBehindTheSamples) {
  const SizeModel truth = some_truth();
  Rng rng(1);
  std::vector<SizeSample> samples;
  for (int i = 0; i < 300; ++i) samples.push_back(sample_of(truth, random_input(rng), std::exp(rng.uniform(-0.1, 0.1))));
  const auto fit = fit_sizes(samples);
  EXPECT_EQ(fit.bakes, 300U);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_NEAR(fit.log_bytes[i], truth.log_bytes[i], 0.03) << i;
    EXPECT_NEAR(fit.log_texels[i], truth.log_texels[i], 0.03) << i;
    EXPECT_NEAR(fit.log_quads[i], truth.log_quads[i], 0.03) << i;
  }
  EXPECT_GT(fit.median_error, 0.02);
  EXPECT_LT(fit.median_error, 0.08);
}

TEST(SizeModel, AFewStrayBakesDoNotMoveTheLaw) {
  const SizeModel truth = some_truth();
  Rng rng(2);
  std::vector<SizeSample> samples;
  for (int i = 0; i < 100; ++i) samples.push_back(sample_of(truth, random_input(rng), i % 10 == 0 ? 0.05 : 1.0));
  const auto fit = fit_sizes(samples);
  const SizeInput typical = input_of(3e4, 12.0, 4.0, 500.0);
  EXPECT_NEAR(estimate_size(fit, typical).bytes / estimate_size(truth, typical).bytes, 1.0, 0.05);
}

TEST(SizeModel, AnySamplesWillDo) {
  const auto prior = default_size_model();
  EXPECT_EQ(fit_sizes({}).log_bytes, prior.log_bytes);
  EXPECT_EQ(fit_sizes({}).bakes, 0U);
  const SizeInput inputs[] = {input_of(1.0, 1.0), input_of(500.0, 1.0), input_of(1e7, 200.0, 150.0, 1e9)};
  for (const SizeInput& input : inputs)
    for (const std::size_t count : {1U, 2U, 7U}) {
      SizeSample sample = sample_of(prior, input);
      sample.baked = {3.0 * sample.baked.bytes, 2.0 * sample.baked.texels, 5.0 * sample.baked.quads};
      const auto fit = fit_sizes(std::vector<SizeSample>(count, sample));  // all alike: slopes stay, levels move
      for (std::size_t i = 1; i < 5; ++i) EXPECT_DOUBLE_EQ(fit.log_bytes[i], prior.log_bytes[i]);
      EXPECT_NEAR(estimate_size(fit, input).bytes, sample.baked.bytes, 1e-9 * sample.baked.bytes);
      EXPECT_NEAR(estimate_size(fit, input).quads, sample.baked.quads, 1e-9 * sample.baked.quads);
      EXPECT_TRUE(std::isfinite(fit.median_error) && std::isfinite(fit.texels_margin) && std::isfinite(fit.quads_margin));
    }
}

TEST(SizeModel, OneLayerOnlyKeepsTheDefaultSlope) {
  SizeModel truth = default_size_model();
  truth.log_bytes[0] += 1.0;
  std::vector<SizeSample> samples;
  for (int i = 1; i <= 10; ++i) samples.push_back(sample_of(truth, input_of(100.0 * i, 1.0)));
  const auto fit = fit_sizes(samples);
  for (const std::size_t i : {2U, 3U, 4U}) EXPECT_DOUBLE_EQ(fit.log_bytes[i], default_size_model().log_bytes[i]);
  EXPECT_NEAR(estimate_size(fit, input_of(500.0, 1.0)).bytes, estimate_size(truth, input_of(500.0, 1.0)).bytes, 1.0);
}

TEST(SizeModel, OneLayerIsItsRectangle) {
  for (const double texels : {50.0, 1e3, 1e5}) {
    const auto size = estimate_size(default_size_model(), input_of(texels, 1.0));
    EXPECT_NEAR(size.bytes / (4.0 * 1.1 * texels), 1.0, 0.03);
    EXPECT_NEAR(size.texels / texels, 1.0, 0.03);
    EXPECT_LT(size.quads, 2.0);
  }
}

TEST(SizeModels, HoldOneEntryForEachTechniqueThatIsOffered) {
  SizeModels sizes = default_size_model();
  EXPECT_TRUE(sizes.offers(Technique::kLayered));
  for (const auto other : {Technique::kDepthMesh, Technique::kPlanar, Technique::kLodSprite}) EXPECT_FALSE(sizes.offers(other));
  SizeModel sprite = default_size_model(Technique::kLodSprite);
  sprite.quads_margin = 7.0;
  sizes.offer(Technique::kLodSprite, sprite);
  EXPECT_EQ(sizes.of(Technique::kLodSprite).quads_margin, 7.0);
  EXPECT_EQ(sizes.of(Technique::kLayered).quads_margin, 1.0);
  EXPECT_FALSE(SizeModels{}.offers(Technique::kLayered));
  EXPECT_THROW(static_cast<void>(sizes.of(Technique::kPlanar)), std::bad_optional_access);
}

// A planar impostor is a layered one of one layer, so to begin with they weigh the same; meshes have a law of their own.
TEST(SizeModels, StartFromTheirTechniquesLaw) {
  const SizeInput input = input_of(3e4, 12.0, 4.0, 500.0);
  const auto bytes = [&](Technique technique) { return estimate_size(default_size_model(technique), input).bytes; };
  EXPECT_EQ(bytes(Technique::kPlanar), bytes(Technique::kLayered));
  EXPECT_NE(bytes(Technique::kDepthMesh), bytes(Technique::kLayered));
  EXPECT_NE(bytes(Technique::kLodSprite), bytes(Technique::kDepthMesh));
}

TEST(SizeModel, CountsTheObjectsOwnRectangles) {
  // Two squares of 1 m at the ends of a row of 8 m, 100 m and 110 m away; a texel is 1 mrad wide.
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0, 0.0, -100.0), Vec3(1.0, 1.0, -100.0)});
  world.add_object({Vec3(7.0, 0.0, -110.0), Vec3(8.0, 1.0, -110.0)});
  ImpostorSketch sketch{3.0, 80.0, 10.0, 105.0, {}, 100.0, 110.0};
  sketch.frame.slope_step = Vec2(1e-3);
  const std::vector<std::uint32_t> objects = {0, 1};
  const ObjectOutlines outlines(world.scene);
  const auto input = size_input(world.scene, outlines, objects, sketch);
  EXPECT_DOUBLE_EQ(input.silhouette_texels, 10.0 * 10.0 + 10.0 * 10.0);
  EXPECT_DOUBLE_EQ(input.block_texels, 12.0 * 12.0 + 12.0 * 12.0);
  EXPECT_DOUBLE_EQ(input.layers, 3.0);
  EXPECT_DOUBLE_EQ(input.layers_crossed, 1.0);
  sketch.width_texels = 15.0;  // never more than the texture
  EXPECT_DOUBLE_EQ(size_input(world.scene, outlines, objects, sketch).silhouette_texels, 150.0);
}

TEST(Outlines, SpanWhatTheVerticesSpan) {
  Scene scene;
  const auto grey = add_material(scene, {});
  const auto cube = add_mesh(scene, make_cube());
  Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    const double turn = rng.uniform(0.0, 6.3);
    const Mat4 at(Vec4(std::cos(turn), 0.0, std::sin(turn), 0.0), Vec4(0.0, 3.0, 0.0, 0.0), Vec4(-std::sin(turn), 0.0, std::cos(turn), 0.0),
                  Vec4(rng.uniform(-9.0, 9.0), 0.0, 0.0, 1.0));
    standin::test::add_object(scene, cube, grey, at);
  }
  update_derived(scene);
  const ObjectOutlines outlines(scene);
  for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
    EXPECT_EQ(outlines.of(object).size(), 8U);  // a cube's corners, each once
    Box spanned;
    for (const Vec3& point : outlines.of(object)) spanned.extend(point);
    EXPECT_EQ(spanned, scene.objects[object].bounds);
  }
}

TEST(SizeModel, FitsRealBakesTheSameOnAnyThreads) {
  ToyWorld world = empty_toy_world();
  const auto cube = add_mesh(world.scene, make_cube());
  const auto grey = add_material(world.scene, {});
  for (int i = 0; i < 4; ++i) {
    Mat4 at(1.0);
    at[3] = Vec4(6.0 * i, 1.0, 0.0, 1.0);
    standin::test::add_object(world.scene, cube, grey, at);
  }
  update_derived(world.scene);
  world.hierarchy = build_hierarchy(world.scene);
  world.camera.width = world.camera.height = 64;
  for (int i = 0; i < 6; ++i) {
    const auto cell = world.add_cell({3, {i, 0, 0}}, {Vec3(10.0 * i - 20.0, 1.7, 60.0), Vec3(10.0 * i - 10.0, 1.7, 70.0)});
    world.add_cpv(cell, {{0, 5.0}, {1, 5.0}, {2, 5.0}, {3, 5.0}});
  }
  const auto set = world.generate();
  ASSERT_GT(set.candidates.size(), 12U);
  const TexturePyramids textures(world.scene);
  const WorkBudget budget;
  const BakeCandidate bake = candidate_baker(world.scene, textures, world.camera, world.quality, budget);
  const auto fit = fit_size_model(world.scene, set.candidates, world.camera, world.quality, 12, 1, 1, {}, bake);
  EXPECT_GE(fit.bakes, 6U);
  EXPECT_LT(fit.median_error, 0.2);
  const auto again = fit_size_model(world.scene, set.candidates, world.camera, world.quality, 12, 1, 3, {}, bake);
  EXPECT_EQ(fit.log_bytes, again.log_bytes);
  EXPECT_EQ(fit.log_texels, again.log_texels);
  EXPECT_EQ(fit.log_quads, again.log_quads);
}

}  // namespace
}  // namespace standin::test
