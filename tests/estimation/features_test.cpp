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
using test::moved;
using test::random_mesh;
using test::random_scene;
using test::random_unit;
using test::with_levels;

const Camera kCamera;
const View kAhead{Vec3(0.0), Vec3(0.0, 0.0, -1.0)};

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
