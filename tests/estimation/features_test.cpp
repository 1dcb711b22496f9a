#include "estimation/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "estimation/feature_table.h"
#include "render/base/error.h"
#include "render/view/direction_interval.h"
#include "small_scenes.h"

namespace standin {
namespace {

using test::add_object;
using test::grid_mesh;
using test::random_mesh;
using test::random_unit;

const Camera kCamera;
const View kAhead{Vec3(0.0), Vec3(0.0, 0.0, -1.0)};

Mat4 moved(double x, double y, double z) {
  return glm::translate(Mat4(1.0), Vec3(x, y, z));
}

TEST(SurfaceSamples, CarryTheWholeAreaAndCount) {
  Rng rng(3);
  for (const int triangles : {1, 7, 64, 65, 1000}) {
    const Mesh mesh = random_mesh(rng, triangles);
    double area_m2 = 0.0;
    for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
      area_m2 += 0.5 * glm::length(glm::cross(Vec3(mesh.positions[3 * i + 1]) - Vec3(mesh.positions[3 * i]),
                                              Vec3(mesh.positions[3 * i + 2]) - Vec3(mesh.positions[3 * i])));
    double edges_m = 0.0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      edges_m += glm::distance(Vec3(mesh.positions[i]), Vec3(mesh.positions[i % 3 == 2 ? i - 2 : i + 1]));
    const SurfaceSamples samples = sample_surface(mesh, 64);
    EXPECT_EQ(samples.samples.size(), 64U);
    EXPECT_EQ(samples.near_samples.size(), 64U * kNearFactor);
    for (const auto* set : {&samples.samples, &samples.near_samples}) {
      SurfaceSample sum;
      double sampled_m2 = 0.0;
      for (const SurfaceSample& sample : *set) {
        sampled_m2 += glm::length(sample.vector_area_m2);
        sum.edges_m += sample.edges_m;
        sum.triangles += sample.triangles;
      }
      EXPECT_NEAR(sampled_m2, area_m2, 1e-9 * area_m2);
      EXPECT_NEAR(sum.edges_m, edges_m, 1e-9 * edges_m);
      EXPECT_NEAR(sum.triangles, triangles, 1e-9 * triangles);
    }
  }
}

// A street of two triangles and a kerb of two thousand: the street has the area, the kerb the count, and neither is forgotten.
TEST(SurfaceSamples, SpreadOverAreaAndCountAlike) {
  Mesh mesh = grid_mesh(50.0F, 1);
  const std::size_t street_corners = mesh.positions.size();
  const Mesh kerb = grid_mesh(0.5F, 32);
  for (const std::uint32_t index : kerb.indices) mesh.indices.push_back(static_cast<std::uint32_t>(street_corners + index));
  for (const glm::vec3& position : kerb.positions) mesh.positions.push_back(position + glm::vec3(0, 0, 1));
  int street = 0;
  double kerb_triangles = 0.0;
  for (const SurfaceSample& sample : sample_surface(mesh, 64).samples) {
    street += sample.point.z == 0.0 ? 1 : 0;
    if (sample.point.z > 0.0) kerb_triangles += sample.triangles;
  }
  EXPECT_GT(street, 20);
  EXPECT_LT(street, 56);
  EXPECT_NEAR(kerb_triangles, 2048.0, 50.0);
}

TEST(SurfaceSamples, OfAnEmptyOrFlatMeshHaveNoArea) {
  EXPECT_TRUE(sample_surface(Mesh{}, 64).samples.empty());
  const Mesh line = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  for (const SurfaceSample& sample : sample_surface(line, 64).samples) {
    EXPECT_EQ(glm::length(sample.vector_area_m2), 0.0);
    EXPECT_NEAR(sample.edges_m, 4.0 / 64, 1e-12);
    EXPECT_NEAR(sample.triangles, 1.0 / 64, 1e-12);
  }
  const Mesh point = test::mesh_of({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  for (const SurfaceSample& sample : sample_surface(point, 64).samples) EXPECT_NEAR(sample.triangles, 1.0 / 64, 1e-12);
}

// A 2 x 2 m square at 20 m covers (f 2/20)^2 pixels, f = 256 / tan(22.5 deg).
TEST(Estimate, OfASquareFacingTheEyeIsItsImage) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 4), moved(0, 0, -20), true);
  const double focal_px = 256.0 / std::tan(std::numbers::pi / 8);
  const Features features = object_features(scene, 0, kAhead, kCamera);
  EXPECT_NEAR(features[Term::kTexturedPixels], std::pow(focal_px * 0.1, 2), 0.002 * std::pow(focal_px * 0.1, 2));
  EXPECT_EQ(features[Term::kPlainPixels], 0.0);
  EXPECT_EQ(features[Term::kDraws], 1.0);
  EXPECT_EQ(features[Term::kTextureSwitches], 0.0);
  EXPECT_EQ(features[Term::kTriangles], 32.0);
  EXPECT_NEAR(features[Term::kOnScreenTriangles], 32.0, 1e-9);
  // 16 cells' outline and diagonal, each a quarter of the square, two triangles each: 53 pixels a triangle.
  const double edges = 16.0 * (4.0 + 2.0 * std::numbers::sqrt2) * 0.25 * focal_px * 0.1;
  EXPECT_NEAR(features[Term::kEdgePixels], edges, 0.01 * edges);
  add_object(scene, grid_mesh(1.0F, 4), moved(0, 0, -5), true);
  EXPECT_NEAR(object_features(scene, 1, kAhead, kCamera)[Term::kEdgePixels], 32.0 * 64.0, 1e-6) << "edges longer than that do not count";
  EXPECT_EQ(features[Term::kFrame], 0.0);
}

TEST(Estimate, OfSubPixelTrianglesHasTheirWholeArea) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 30), moved(0, 0, -200), false);
  const double focal_px = 256.0 / std::tan(std::numbers::pi / 8);
  const double pixels = std::pow(focal_px * 0.01, 2);  // 38 pixels of 1800 triangles
  const Features features = object_features(scene, 0, kAhead, kCamera);
  EXPECT_NEAR(features[Term::kOnScreenTriangles], 1800.0, 1e-6);
  EXPECT_NEAR(features[Term::kPlainPixels], pixels, 0.002 * pixels);
  EXPECT_EQ(features[Term::kTextureSwitches], 0.0);
}

TEST(Estimate, FallsWithTheCosineOfAGrazingView) {
  Scene scene;
  const double angle = 1.2;
  add_object(scene, grid_mesh(1.0F, 8), moved(0, 0, -50) * glm::rotate(Mat4(1.0), angle, Vec3(0, 1, 0)), false);
  const double focal_px = kCamera.focal_px();
  const double expected = std::pow(focal_px * 2.0 / 50.0, 2) * std::cos(angle);
  EXPECT_NEAR(object_features(scene, 0, kAhead, kCamera)[Term::kPlainPixels], expected, 0.01 * expected);
}

TEST(Estimate, GrowsTowardsTheCornerAsTheProjectionDoes) {
  // Perpendicular to the image plane's axis: a patch at the corner has the same size in pixels as at the centre, though farther away.
  Scene scene;
  const double corner = 0.9 * 50.0 * kCamera.tan_half_x();
  add_object(scene, grid_mesh(1.0F, 8), moved(corner, corner, -50), false);
  const double expected = std::pow(kCamera.focal_px() * 2.0 / 50.0, 2);
  EXPECT_NEAR(object_features(scene, 0, kAhead, kCamera)[Term::kPlainPixels], expected, 0.01 * expected);
}

TEST(Estimate, HalvesWhenHalfIsOffScreen) {
  Scene scene;
  add_object(scene, grid_mesh(4.0F, 20), moved(50.0 * kCamera.tan_half_x(), 0, -50), false);
  const Features features = object_features(scene, 0, kAhead, kCamera);
  EXPECT_NEAR(features[Term::kOnScreenTriangles] / features[Term::kTriangles], 0.5, 0.1);
  EXPECT_NEAR(features[Term::kPlainPixels], 0.5 * std::pow(kCamera.focal_px() * 8.0 / 50.0, 2),
              0.05 * std::pow(kCamera.focal_px() * 8.0 / 50.0, 2));
}

// A wall of two triangles, 40 m wide, from 2 m away: the image is a small part of it, and full.
TEST(Estimate, OfANearWallFillsTheScreen) {
  Scene scene;
  for (const double angle : {0.0, 0.3, 0.7})
    add_object(scene, grid_mesh(20.0F, 1), moved(0, 0, -2) * glm::rotate(Mat4(1.0), angle, Vec3(0, 1, 0)), false);
  for (std::uint32_t id = 0; id < 3; ++id) {
    const double pixels = object_features(scene, id, kAhead, kCamera)[Term::kPlainPixels];
    EXPECT_NEAR(pixels, 512.0 * 512.0, 0.45 * 512.0 * 512.0) << id;
  }
}

TEST(Estimate, IsZeroOutsideTheFrustum) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 2), moved(0, 0, 20), true);
  add_object(scene, grid_mesh(1.0F, 2), moved(30, 0, -20), true);
  for (const std::uint32_t id : {0U, 1U})
    for (const double value : object_features(scene, id, kAhead, kCamera).value) EXPECT_EQ(value, 0.0);
}

TEST(Estimate, OfACulledBackSideHasNoPixels) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 2), moved(0, 0, -20), false, AlphaMode::kOpaque, false);
  const Mat4 turned = moved(0, 0, -20) * glm::rotate(Mat4(1.0), std::numbers::pi, Vec3(0, 1, 0));
  add_object(scene, grid_mesh(1.0F, 2), turned, false, AlphaMode::kOpaque, false);
  const Mat4 mirrored = moved(0, 0, -20) * glm::scale(Mat4(1.0), Vec3(-1, 1, 1));  // winding flips, front stays front (glTF)
  add_object(scene, grid_mesh(1.0F, 2), mirrored, false, AlphaMode::kOpaque, false);
  EXPECT_GT(object_features(scene, 0, kAhead, kCamera)[Term::kPlainPixels], 0.0);
  EXPECT_EQ(object_features(scene, 1, kAhead, kCamera)[Term::kPlainPixels], 0.0);
  EXPECT_EQ(object_features(scene, 1, kAhead, kCamera)[Term::kTriangles], 8.0);
  EXPECT_DOUBLE_EQ(object_features(scene, 2, kAhead, kCamera)[Term::kPlainPixels],
                   object_features(scene, 0, kAhead, kCamera)[Term::kPlainPixels]);
}

TEST(Estimate, NamesPixelsAsTheRendererDrawsThem) {
  Scene scene;
  add_object(scene, grid_mesh(1.0F, 2), moved(0, 0, -20), true, AlphaMode::kMask);
  add_object(scene, grid_mesh(1.0F, 2), moved(0, 0, -20), false, AlphaMode::kMask);  // nothing to test: plain
  add_object(scene, grid_mesh(1.0F, 2), moved(0, 0, -20), true);
  scene.meshes[2].uvs.clear();
  const FeatureTable table(scene, kCamera);
  const PreparedView view(kAhead, kCamera);
  EXPECT_GT(table.estimate(0, view)[Term::kMaskedPixels], 0.0);
  EXPECT_GT(table.estimate(1, view)[Term::kPlainPixels], 0.0);
  EXPECT_GT(table.estimate(2, view)[Term::kPlainPixels], 0.0);
  EXPECT_EQ(table.estimate(2, view)[Term::kTextureSwitches], 0.0);
}

// Against the exact areas of the projected triangles (shoelace), all of them on screen.
TEST(Estimate, AgreesWithProjectedTriangles) {
  double sum_of_errors = 0.0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng(seed, 5);
    Scene scene;
    const Mat4 world_from_object = moved(rng.uniform(-2, 2), rng.uniform(-2, 2), -rng.uniform(15, 60)) *
                                   glm::rotate(Mat4(1.0), rng.uniform(0, 6), random_unit(rng)) *
                                   glm::scale(Mat4(1.0), Vec3(rng.uniform(0.5, 2), rng.uniform(0.5, 2), rng.uniform(0.5, 2)));
    add_object(scene, random_mesh(rng, 300), world_from_object, false);
    const Mesh& mesh = scene.meshes[0];
    double pixels = 0.0;
    for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
      std::array<Vec2, 3> image{Vec2(0.0), Vec2(0.0), Vec2(0.0)};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 world(world_from_object * Vec4(Vec3(mesh.positions[i + k]), 1.0));
        image[k] = kCamera.focal_px() * Vec2(world) / -world.z;
      }
      const Vec2 a = image[1] - image[0], b = image[2] - image[0];
      pixels += 0.5 * std::abs(a.x * b.y - a.y * b.x);
    }
    const double estimate = object_features(scene, 0, kAhead, kCamera)[Term::kPlainPixels];
    EXPECT_NEAR(estimate, pixels, 0.25 * pixels) << "seed " << seed;
    sum_of_errors += estimate / pixels - 1.0;
  }
  EXPECT_NEAR(sum_of_errors / 40, 0.0, 0.03);  // unbiased
}

TEST(Estimate, DoesNotDependOnWhereInTheWorldTheSceneLies) {
  Rng rng(11);
  const Mesh mesh = random_mesh(rng, 100);
  Scene near, far;
  add_object(near, mesh, moved(1, 2, -9), true);
  add_object(far, mesh, moved(4e6 + 1, 2, 7e6 - 9), true);
  const Features a = object_features(near, 0, kAhead, kCamera);
  const Features b = object_features(far, 0, {Vec3(4e6, 0, 7e6), kAhead.direction}, kCamera);
  for (std::size_t i = 0; i < kTermCount; ++i) EXPECT_NEAR(a.value[i], b.value[i], 1e-6 * a.value[i]);
}

Scene random_scene(Rng& rng) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const Mat4 transform = moved(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-5, 5)) *
                           glm::rotate(Mat4(1.0), rng.uniform(0, 6), random_unit(rng)) *
                           glm::scale(Mat4(1.0), Vec3(rng.uniform(0.1, 3), rng.uniform(-3, -0.1), rng.uniform(0.1, 3)));
    Mesh mesh = i == 0 ? grid_mesh(2.0F, 3) : random_mesh(rng, static_cast<int>(1 + rng.below(200)));
    add_object(scene, std::move(mesh), transform, i % 2 == 0, i == 2 ? AlphaMode::kMask : AlphaMode::kOpaque, i != 3);
  }
  return scene;
}

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

// Every object at three further levels: half, a quarter, an eighth of its triangles, from ever farther.
Scene with_levels(Scene scene, Rng& rng) {
  for (Object& object : scene.objects) {
    const auto original = scene.parts[object.first_part];
    double distance_m = 0.0;
    for (int k = 1; k <= 3; ++k) {
      Mesh simple = scene.meshes[original.mesh];
      simple.indices.resize(std::max<std::size_t>(3, (simple.indices.size() >> k) / 3 * 3));
      simple.simplified_from = static_cast<std::int32_t>(original.mesh);
      distance_m += std::pow(10.0, rng.uniform(-1.5, 1.0));
      object.levels.push_back({static_cast<std::uint32_t>(scene.parts.size()), 1, simple.triangle_count(), 0.0, -1.0, distance_m});
      scene.parts.push_back({static_cast<std::uint32_t>(scene.meshes.size()), original.material});
      scene.meshes.push_back(std::move(simple));
    }
  }
  update_derived(scene);
  return scene;
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

TEST(Features, AFrameShowsEachObjectAtItsLevel) {
  Rng rng(4);
  const Scene scene = with_levels(random_scene(rng), rng);
  const FeatureTable table(scene, kCamera);
  const std::vector<std::uint32_t> objects = {0, 1, 2, 3};
  const View view{Vec3(0, 0, 40), Vec3(0, 0, -1)};
  const Features plain = table.frame(objects, view), simple = table.frame(objects, view, std::vector<std::uint8_t>{3, 0, 1, 2});
  double triangles = 0.0;
  for (const auto& [id, level] : {std::pair(0U, 3U), std::pair(1U, 0U), std::pair(2U, 1U), std::pair(3U, 2U)})
    triangles += table.estimate(id, PreparedView(view, kCamera), level)[Term::kTriangles];
  EXPECT_EQ(simple[Term::kTriangles], triangles);
  EXPECT_LT(triangles, plain[Term::kTriangles]);
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
    const DirectionCone cone = enclosing_cone(interval_of(glm::normalize(bounds.centre() - eye), 4), kCamera);
    const ObjectFromBox close = table.from_box(object, {eyes, eyes}), each = table.from_box(object, {eyes, everywhere});
    const auto blocks = [](const ObjectFromBox& from) {
      std::size_t count = 0;
      for (const auto& part : from.parts) count += part.samples.size();
      return count;
    };
    together += blocks(close) < blocks(each) ? 1 : 0;
    const Gaze gaze(cone, eyes, kCamera);
    const Features of_close = table.bound(close, gaze), of_each = table.bound(each, gaze);
    for (std::size_t t = 0; t < kTermCount; ++t) {
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

// Of what objects have alone, a frame has all but the pixels that other objects hide: never more, and never more than fit into the image.
TEST(FeatureTable, AFrameIsTheSumOfItsObjectsLessWhatTheyHide) {
  int hidden = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed, 2);
    const Scene scene = random_scene(rng);
    const FeatureTable table(scene, kCamera);
    const View view{scene.bounds.centre() + Vec3(0, 0, rng.uniform(1.0, 30.0)), kAhead.direction};
    Features alone = frame_features();
    for (std::uint32_t id = 0; id < 4; ++id) alone += object_features(scene, id, view, kCamera);
    const std::vector<std::uint32_t> all = {0, 1, 2, 3};
    const Features frame = table.frame(all, view);
    for (std::size_t i = 0; i < kTermCount; ++i) {
      if (!is_pixel_term(static_cast<Term>(i))) {
        ASSERT_NEAR(frame.value[i], alone.value[i], 1e-12 * alone.value[i]) << term_name(static_cast<Term>(i)) << ", seed " << seed;
        continue;
      }
      ASSERT_LE(frame.value[i], alone.value[i] * (1.0 + 1e-12)) << term_name(static_cast<Term>(i)) << ", seed " << seed;
      hidden += frame.value[i] < 0.9 * alone.value[i] ? 1 : 0;
    }
    ASSERT_LE(frame[Term::kPlainPixels] + frame[Term::kTexturedPixels] + frame[Term::kMaskedPixels],
              table.most_passed_pixels() * (1.0 + 1e-12));
    EXPECT_EQ(table.frame({}, view).value, frame_features().value);
  }
  EXPECT_GT(hidden, 5);
}

TEST(Terms, HaveDistinctNames) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kTermCount; ++i) names.insert(term_name(static_cast<Term>(i)));
  EXPECT_EQ(names.size(), kTermCount);
  EXPECT_FALSE(names.contains(""));
}

}  // namespace
}  // namespace standin
