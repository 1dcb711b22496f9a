// Bounds of features over boxes of eyes and over gazes: never below what any view shows, never larger for fewer eyes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "estimation/feature_table.h"
#include "render/base/error.h"
#include "render/view/direction_interval.h"
#include "small_scenes.h"

namespace standin {
namespace {

using test::add_object;
using test::grid_mesh;
using test::random_scene;
using test::random_unit;
using test::with_levels;

const Camera kCamera;

// A random box that holds the eye: half of the time the eye itself, or flat.
Box box_around(const Vec3& eye, Rng& rng) {
  const auto reach = [&] {
    return Vec3(rng.uniform(), rng.below(2) * rng.uniform(), rng.uniform()) * std::pow(10.0, rng.uniform(-2.0, 1.5));
  };
  return rng.below(4) == 0 ? Box{eye, eye} : Box{eye - reach(), eye + reach()};
}

Box larger(const Box& box, Rng& rng) {
  return {box.min - 5.0 * Vec3(rng.uniform(), rng.uniform(), rng.uniform()), box.max + 5.0 * Vec3(rng.uniform())};
}

// Eyes at one point, `distance_m` along +z.
Box eye_at(double distance_m) {
  return {Vec3(0, 0, distance_m), Vec3(0, 0, distance_m)};
}

TEST(Bound, IsNeverBelowAnEstimateFromItsBox) {
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed, 7);
    const Scene scene = random_scene(rng);
    Camera camera;
    camera.fov_y_rad = rng.uniform(0.2, 2.4);
    camera.width = seed % 3 == 0 ? 900 : 512;
    const FeatureTable table(scene, camera);
    for (int i = 0; i < 300; ++i) {
      const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
      const Box& bounds = scene.objects[object].bounds;
      const Vec3 eye = bounds.centre() + std::pow(10.0, rng.uniform(-3.0, 2.0)) * random_unit(rng);
      const Vec3 towards = bounds.centre() - eye + 0.5 * glm::length(bounds.centre() - eye) * rng.uniform() * random_unit(rng);
      const View view{eye, glm::normalize(towards)};
      const Features estimate = table.estimate(object, PreparedView(view, camera));
      const Box eyes = box_around(eye, rng);
      const Features from_box = table.bound(object, eyes);
      const Features from_larger = table.bound(object, larger(eyes, rng));
      seen += estimate[Term::kDraws] > 0.0 ? 1 : 0;
      for (std::size_t t = 0; t < kTermCount; ++t) {
        ASSERT_LE(estimate.value[t], from_box.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << seed << ", view " << i;
        ASSERT_LE(from_box.value[t], from_larger.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << seed << ", view " << i;
        ASSERT_TRUE(std::isfinite(from_larger.value[t]));
      }
    }
  }
  EXPECT_GT(seen, 10000);
}

// A cell shows the level that its own box chooses: an estimate at that level is within its bound, and a smaller cell, which may show a
// coarser level, has no larger one.
TEST(Bound, WithLevelsOfDetailIsStillNeverBelowAnEstimateAndMonotone) {
  int simpler = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng(seed, 17);
    const Scene scene = with_levels(random_scene(rng), rng);
    const Camera camera;
    const FeatureTable table(scene, camera);
    for (int i = 0; i < 200; ++i) {
      const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
      const Box& bounds = scene.objects[object].bounds;
      const Vec3 eye = bounds.centre() + std::pow(10.0, rng.uniform(-3.0, 2.0)) * random_unit(rng);
      const View view{eye, glm::normalize(bounds.centre() - eye)};
      const Box eyes = box_around(eye, rng);
      const std::uint32_t level = level_from(scene.objects[object], eyes);
      const Features estimate = table.estimate(object, PreparedView(view, camera), level);
      const Features from_box = table.bound(object, eyes);
      const Features from_larger = table.bound(object, larger(eyes, rng));
      const Features own = table.estimate(object, PreparedView(view, camera));
      simpler += level > 0 && estimate[Term::kTriangles] < own[Term::kTriangles] ? 1 : 0;
      for (std::size_t t = 0; t < kTermCount; ++t) {
        ASSERT_LE(estimate.value[t], from_box.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << seed << ", view " << i;
        ASSERT_LE(from_box.value[t], from_larger.value[t] * (1.0 + 1e-12)) << term_name(static_cast<Term>(t)) << ", seed " << seed;
        ASSERT_LE(estimate.value[t], own.value[t] * (1.0 + 1e-12)) << term_name(static_cast<Term>(t)) << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(simpler, 1000);
}

// Over the views of one region: between an estimate in it and the bound for any direction, and no more for fewer eyes.
TEST(Bound, OfAGazeLiesBetweenItsViewsAndAnyDirection) {
  int seen = 0, sharper = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed, 8);
    const Scene scene = random_scene(rng);
    Camera camera;
    camera.fov_y_rad = rng.uniform(0.2, 2.4);
    const FeatureTable table(scene, camera);
    for (int i = 0; i < 100; ++i) {
      const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
      const Box& bounds = scene.objects[object].bounds;
      const Vec3 eye = bounds.centre() + std::pow(10.0, rng.uniform(-3.0, 2.0)) * random_unit(rng);
      const Vec3 towards = bounds.centre() - eye + 2.0 * glm::length(bounds.centre() - eye) * rng.uniform() * random_unit(rng);
      const View view{eye, glm::normalize(towards)};
      const Box eyes = box_around(eye, rng), more_eyes = larger(eyes, rng);
      const DirectionCone cone = enclosing_cone(interval_of(view.direction, static_cast<int>(rng.below(6))), camera);
      const Features estimate = table.estimate(object, PreparedView(view, camera));
      const Features of_gaze = table.bound(table.from_box(object, {eyes, more_eyes}), Gaze(cone, eyes, camera));
      const Features of_larger = table.bound(table.from_box(object, {more_eyes, more_eyes}), Gaze(cone, more_eyes, camera));
      const Features of_any = table.bound(object, eyes);
      seen += estimate[Term::kOnScreenTriangles] > 0.0 ? 1 : 0;
      sharper += of_gaze[Term::kEdgePixels] < 0.99 * of_any[Term::kEdgePixels] ? 1 : 0;
      for (std::size_t t = 0; t < kTermCount; ++t) {
        ASSERT_LE(estimate.value[t], of_gaze.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << seed << ", view " << i;
        ASSERT_LE(of_gaze.value[t], of_larger.value[t] * (1.0 + 1e-9)) << term_name(static_cast<Term>(t)) << ", seed " << seed;
        ASSERT_LE(of_gaze.value[t], of_any.value[t] * (1.0 + 1e-9)) << term_name(static_cast<Term>(t)) << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(seen, 2000);
  EXPECT_GT(sharper, 1000);
}

// A ground of 100 x 100 m: looking along it sees a slice, away from it nothing.
TEST(Bound, OfAGazeCountsThePartInFront) {
  Scene scene;
  add_object(scene, grid_mesh(50.0F, 40), Mat4(1.0), false);  // in the plane z = 0
  const FeatureTable table(scene, kCamera);
  const auto share = [&](double height_m, const Vec3& direction) {
    const DirectionCone cone = enclosing_cone(interval_of(direction, 5), kCamera);
    const Features bound = table.bound(table.from_box(0, {eye_at(height_m), eye_at(height_m)}), Gaze(cone, eye_at(height_m), kCamera));
    return bound[Term::kOnScreenTriangles] / bound[Term::kTriangles];
  };
  // 45 degrees of view and 2.8 of directions of all around; a patch nearer than its size counts wherever it is.
  EXPECT_NEAR(share(1.7, {1.0, 0.02, -0.02}), 47.8 / 360.0, 0.05);
  EXPECT_EQ(share(10.0, {0.01, 0.02, 1.0}), 0.0);
}

// As seen from `all`, a close group of samples is one; from a box around the object itself, none is.
TEST(Bound, OfCloseSamplesTogetherIsHardlyLooser) {
  int together = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed, 12);
    const Scene scene = random_scene(rng);
    const FeatureTable table(scene, kCamera);
    const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
    const Box& bounds = scene.objects[object].bounds;
    const Vec3 eye = bounds.centre() + std::pow(10.0, rng.uniform(0.5, 2.5)) * bounds.diagonal() * random_unit(rng);
    const Box eyes = box_around(eye, rng);
    Box everywhere = eyes;
    everywhere.extend(bounds.min), everywhere.extend(bounds.max);
    const View view{eye, glm::normalize(bounds.centre() - eye)};
    const DirectionCone cone = enclosing_cone(interval_of(view.direction, 4), kCamera);
    const ObjectFromBox close = table.from_box(object, {eyes, eyes}), each = table.from_box(object, {eyes, everywhere});
    const auto blocks = [](const ObjectFromBox& from) {
      std::size_t count = 0;
      for (const auto& part : from.parts) count += part.samples.size();
      return count;
    };
    together += blocks(close) < blocks(each) ? 1 : 0;
    const Gaze gaze(cone, eyes, kCamera);
    const Features of_close = table.bound(close, gaze), of_each = table.bound(each, gaze);
    const Features estimate = table.estimate(object, PreparedView(view, kCamera));
    for (std::size_t t = 0; t < kTermCount; ++t) {
      ASSERT_LE(estimate.value[t], of_close.value[t]) << term_name(static_cast<Term>(t)) << ", seed " << seed;
      ASSERT_GE(of_close.value[t], of_each.value[t] * (1.0 - 1e-9)) << term_name(static_cast<Term>(t)) << ", seed " << seed;
      ASSERT_LE(of_close.value[t], of_each.value[t] * 1.05) << term_name(static_cast<Term>(t)) << ", seed " << seed;
    }
  }
  EXPECT_GT(together, 50);
}

TEST(Bound, OfAFarFacingSquareIsItsImageAtTheCorner) {
  Scene scene;
  add_object(scene, grid_mesh(0.01F, 4), Mat4(1.0), false);
  const double magnification = std::pow(std::cos(kCamera.half_diagonal_rad()), -3.0);
  const double expected = magnification * std::pow(kCamera.focal_px() * 0.02 / 10.0, 2);
  EXPECT_NEAR(object_features_bound(scene, 0, eye_at(10.0), kCamera)[Term::kPlainPixels], expected, 0.01 * expected);
}

TEST(Bound, OfAClosedCulledSurfaceCountsHalf) {
  // Two squares back to back: only one faces any eye.
  Scene scene;
  Mesh mesh = grid_mesh(0.01F, 4);
  Mesh back = mesh;
  for (std::size_t i = 0; i + 2 < back.indices.size(); i += 3) std::swap(back.indices[i], back.indices[i + 1]);
  for (const std::uint32_t index : back.indices) mesh.indices.push_back(index);
  add_object(scene, mesh, Mat4(1.0), false, AlphaMode::kOpaque, false);
  add_object(scene, mesh, Mat4(1.0), false, AlphaMode::kOpaque, true);
  const double culled = object_features_bound(scene, 0, eye_at(10.0), kCamera)[Term::kPlainPixels];
  const double double_sided = object_features_bound(scene, 1, eye_at(10.0), kCamera)[Term::kPlainPixels];
  EXPECT_NEAR(culled / double_sided, 0.5, 0.01);
}

// A ground of 100 x 100 m, the eye 1.7 m above its middle: the far parts count at their own distance and slope, not at 1.7 m and face on.
TEST(Bound, OfALargeObjectCountsEachPartAtItsOwnDistance) {
  Scene scene;
  add_object(scene, grid_mesh(50.0F, 40), Mat4(1.0), false);
  const Features bound = object_features_bound(scene, 0, eye_at(1.7), kCamera);
  const double screens = bound[Term::kPlainPixels] / (512.0 * 512.0);
  EXPECT_NEAR(bound[Term::kOnScreenTriangles], bound[Term::kTriangles], 1e-6);
  // The half space below is 2 pi sr; the image of 1 sr has f^2 pixels at least and f^2 / cos^3 at most.
  const double focal2 = std::pow(kCamera.focal_px(), 2) / (512.0 * 512.0);
  EXPECT_LT(screens, 1.1 * 2.0 * std::numbers::pi * focal2 * std::pow(std::cos(kCamera.half_diagonal_rad()), -3.0));
  EXPECT_GT(screens, 1.0);
}

TEST(Bound, OfWhatFacesAwayFromTheWholeBoxIsNothing) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 4), Mat4(1.0), false, AlphaMode::kOpaque, false);  // faces +z
  EXPECT_EQ(object_features_bound(scene, 0, {Vec3(-5, -5, -9), Vec3(5, 5, -4)}, kCamera)[Term::kPlainPixels], 0.0);
  EXPECT_EQ(object_features_bound(scene, 0, {Vec3(-5, -5, -9), Vec3(5, 5, -4)}, kCamera)[Term::kOnScreenTriangles], 0.0);
  EXPECT_GT(object_features_bound(scene, 0, {Vec3(-5, -5, -9), Vec3(5, 5, 0.1)}, kCamera)[Term::kPlainPixels], 0.0);
}

TEST(Bound, RefusesNoEyes) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 1), Mat4(1.0), false);
  EXPECT_THROW((void)object_features_bound(scene, 0, Box{}, kCamera), Failure);
}

}  // namespace
}  // namespace standin
