#include "placement/candidates/size_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/placement/candidates/toy_world.h"
#include "tests/support/scene_builder.h"

namespace standin::test {
namespace {

SizeSample sample_of(const SizeModel& truth, double silhouette_texels, double layers, double noise = 1.0) {
  const SizeInput input{silhouette_texels, layers};
  SizeEstimate size = estimate_size(truth, input);
  size.bytes *= noise;
  return {input, size};
}

TEST(SizeModel, FitFindsTheLawBehindTheSamples) {
  SizeModel truth;
  truth.log_bytes = {1.7, 0.8, 0.6};
  truth.log_quads = {0.5, 0.2, 1.1};
  Rng rng(1);
  std::vector<SizeSample> samples;
  for (int i = 0; i < 60; ++i)
    samples.push_back(
        sample_of(truth, std::exp(rng.uniform(5.0, 12.0)), std::exp(rng.uniform(0.0, 5.0)), std::exp(rng.uniform(-0.1, 0.1))));
  const auto fit = fit_sizes(samples);
  EXPECT_EQ(fit.bakes, 60U);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_NEAR(fit.log_bytes[i], truth.log_bytes[i], 0.03);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_NEAR(fit.log_quads[i], truth.log_quads[i], 0.01);
  EXPECT_GT(fit.median_error, 0.02);
  EXPECT_LT(fit.median_error, 0.08);
}

TEST(SizeModel, OneLayerOnlyKeepsTheDefaultSlope) {
  SizeModel truth = default_size_model();
  truth.log_bytes[0] += 1.0;
  std::vector<SizeSample> samples;
  for (int i = 1; i <= 10; ++i) samples.push_back(sample_of(truth, 100.0 * i, 1.0));
  const auto fit = fit_sizes(samples);
  EXPECT_DOUBLE_EQ(fit.log_bytes[2], default_size_model().log_bytes[2]);
  EXPECT_NEAR(estimate_size(fit, {500.0, 1.0}).bytes, estimate_size(truth, {500.0, 1.0}).bytes, 10.0);
  EXPECT_EQ(fit_sizes({}).log_bytes, default_size_model().log_bytes);
  EXPECT_EQ(fit_sizes({}).bakes, 0U);
}

TEST(SizeModel, DefaultIsNearTheRuleItStandsFor) {
  for (const double s : {1e3, 3e3, 1e4})
    for (const double n : {1.0, 5.0, 20.0, 100.0}) {
      const double texels = n == 1.0 ? 1.25 * s : 1.25 * (1.3 * s + 1.5 * n * std::sqrt(s));
      const double ratio = estimate_size(default_size_model(), {s, n}).bytes / (4.0 * texels);
      EXPECT_GT(ratio, 0.6) << s << " " << n;
      EXPECT_LT(ratio, 1.7) << s << " " << n;
    }
}

TEST(SizeModel, SilhouetteIsTheObjectsShareOfTheTexture) {
  // Two boxes of a quarter of the cluster's front each, seen along z from 100 m.
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0, 0.0, 0.0), Vec3(1.0, 1.0, 0.0)});
  world.add_object({Vec3(3.0, 0.0, 0.0), Vec3(4.0, 1.0, 0.0)});
  const Shaft shaft = shaft_frame(Vec3(2.0, 0.5, 0.0), Vec3(0.0, 0.0, 1.0));
  const ImpostorSketch sketch{3.0, 400.0, 100.0, 100.0};
  const std::vector<std::uint32_t> objects = {0, 1};
  const auto input = size_input(world.scene, objects, {Vec3(0.0), Vec3(4.0, 1.0, 0.0)}, shaft, sketch);
  EXPECT_DOUBLE_EQ(input.silhouette_texels, 0.5 * 400.0 * 100.0);
  EXPECT_DOUBLE_EQ(input.layers, 3.0);
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
  const auto fit = fit_size_model(world.scene, set.candidates, world.camera, world.quality, 12, 1, 1, {});
  EXPECT_GE(fit.bakes, 6U);
  EXPECT_LT(fit.median_error, 0.6);
  const auto again = fit_size_model(world.scene, set.candidates, world.camera, world.quality, 12, 1, 3, {});
  EXPECT_EQ(fit.log_bytes, again.log_bytes);
  EXPECT_EQ(fit.log_quads, again.log_quads);
}

}  // namespace
}  // namespace standin::test
