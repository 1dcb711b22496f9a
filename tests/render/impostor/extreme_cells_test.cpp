// View cells, distances, textures and cameras at the ends of their ranges: each either gives an impostor that keeps its promise, or is
// refused with the reason. (Meshes at the ends of theirs: extreme_meshes_test.cpp.)
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/impostor/impostor_glb.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin {
namespace {

using test::rectangle;
using test::SmallScene;
using test::Verdict;
using test::WorldTriangle;

constexpr double kDegree = 0.017453292519943295;

ViewCell shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

/// A cube of a few random triangles about the origin, one metre a side.
struct Cluster {
  explicit Cluster(double size_m = 1.0) {
    Rng rng(17);
    const auto triangles = test::random_triangles(rng, {Vec3(-0.5 * size_m), Vec3(0.5 * size_m)}, 40);
    surfaces = test::opaque_surfaces(triangles);
    SmallScene small;
    small.add_object(triangles);
    scene = std::move(small.scene);
  }
  [[nodiscard]] const Box& bounds() const { return scene.objects[0].bounds; }

  Scene scene;
  std::vector<test::Surface> surfaces;
};

Verdict judged(const Cluster& cluster, const ViewCell& cell, const Camera& camera = {}, const BakeQuality& quality = {}) {
  const Impostor impostor = bake_layered(cluster.scene, {{0}, cell}, camera, quality);
  return test::judge(cluster.surfaces, impostor, quality.alpha_scale * camera.pixel_angle_rad(), 300, 5);
}

void expect_kept(const Verdict& verdict, int least_judged) {
  EXPECT_GE(verdict.judged, least_judged);
  EXPECT_EQ(verdict.gaps, 0);
  EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
}

std::string why_not(const Box& objects, const ViewCell& cell, const Camera& camera = {}, const BakeQuality& quality = {}) {
  const ImpostorPlan plan = plan_impostor(objects, cell, camera, quality);
  EXPECT_EQ(plan.possible, std::isfinite(sketch_impostor(objects, cell, camera, quality).layers)) << plan.why_not;
  return plan.possible ? "" : plan.why_not;
}

// One viewpoint sees no parallax: one layer, however deep the cluster is.
TEST(ExtremeCells, OfNoSizeNeedOneLayer) {
  const Cluster cluster(6.0);
  const Box point{Vec3(1.0, 2.0, 20.0), Vec3(1.0, 2.0, 20.0)};
  const ImpostorPlan plan = plan_impostor(cluster.bounds(), point, {}, {});
  ASSERT_TRUE(plan.possible) << plan.why_not;
  EXPECT_EQ(plan.layers.size(), 1U);
  EXPECT_EQ(plan.frame.reference_viewpoint, point.min);
  expect_kept(judged(cluster, point), 150);
}

TEST(ExtremeCells, WithoutAreaOrWithoutDepthKeepThePromise) {
  const Cluster cluster(6.0);
  expect_kept(judged(cluster, Box{Vec3(-2.0, 1.0, 20.0), Vec3(3.0, 1.0, 20.0)}), 150);   // a line across
  expect_kept(judged(cluster, Box{Vec3(1.0, 1.0, 20.0), Vec3(1.0, 1.0, 60.0)}), 100);    // a line away
  expect_kept(judged(cluster, Box{Vec3(-2.0, -1.0, 20.0), Vec3(3.0, 1.0, 20.0)}), 150);  // a plane
  Shaft ray = std::get<Shaft>(shaft_towards_z(0.0, 20.0));
  expect_kept(judged(cluster, ray), 100);
  ray.tan_half = Vec2(0.2, 0.0);
  expect_kept(judged(cluster, ray), 100);
}

// F1 of the thesis' own layers: straight back from a narrow cell the image zooms, and points off the axis move.
TEST(ExtremeCells, NarrowAndDeepOnesKeepThePromise) {
  const Cluster cluster(6.0);
  for (const auto& [width, depth] : {std::pair{0.2, 50.0}, {1e-3, 500.0}, {1e-6, 1e4}}) {
    SCOPED_TRACE("width " + std::to_string(width) + " depth " + std::to_string(depth));
    expect_kept(judged(cluster, Box{Vec3(-0.5 * width, -0.5 * width, 20.0), Vec3(0.5 * width, 0.5 * width, 20.0 + depth)}), 20);
  }
}

TEST(ExtremeCells, AThousandthOfTheObjectAwayAskForTooLargeATexture) {
  const Box object{Vec3(-0.5), Vec3(0.5)};
  EXPECT_EQ(why_not(object, shaft_towards_z(0.1, 0.5 + 1e-3)), "texture too large");
  EXPECT_EQ(why_not(object, Box{Vec3(-0.1, -0.1, 0.501), Vec3(0.1, 0.1, 0.501)}), "texture too large");
  EXPECT_EQ(why_not(object, Box{Vec3(-0.1, -0.1, 0.5 + 1e-15), Vec3(0.1, 0.1, 2.0)}), "texture too large");
}

TEST(ExtremeCells, TenMillionObjectsAwayNeedOneTexelOnOneLayer) {
  const Cluster cluster;
  for (const ViewCell& cell : {shaft_towards_z(0.4, 1e7), ViewCell(Box{Vec3(-1e6, -1e6, 1e7), Vec3(1e6, 1e6, 5e7)})}) {
    const Impostor impostor = bake_layered(cluster.scene, {{0}, cell}, {}, {});
    EXPECT_EQ(impostor.layers.size(), 1U);
    EXPECT_EQ(impostor.texel_count(), 1U);
    EXPECT_EQ(impostor.texels[3], 255);
    const double depth = glm::dot(-impostor.frame.reference_viewpoint, impostor.frame.forward);
    EXPECT_NEAR(impostor.layers[0].distance_m, depth, 0.5);
  }
}

TEST(ExtremeCells, ThatTheClusterTouchesOrEnclosesAreRefused) {
  const Box object{Vec3(-1), Vec3(1)};
  const std::string reaches_in = "cluster reaches into the view cell";
  EXPECT_EQ(why_not(object, shaft_towards_z(0.2, 1.0)), reaches_in);            // its face lies on the near plane
  EXPECT_EQ(why_not(object, Box{Vec3(-1, -1, 1), Vec3(1, 1, 5)}), reaches_in);  // faces touch
  EXPECT_EQ(why_not(object, Box{Vec3(1, 1, 1), Vec3(2, 2, 2)}), reaches_in);    // corners touch
  EXPECT_EQ(why_not(object, Box{Vec3(-0.5), Vec3(0.5)}), reaches_in);           // encloses it
  EXPECT_EQ(why_not(object, Box{Vec3(-9), Vec3(9)}), reaches_in);               // lies inside
  EXPECT_EQ(why_not(object, object), reaches_in);
  EXPECT_EQ(why_not(object, shaft_towards_z(0.2, 0.0)), reaches_in);
  const Cluster cluster(2.0);
  try {
    (void)bake_layered(cluster.scene, {{0}, Box{Vec3(-0.5), Vec3(0.5)}}, {}, {});
    FAIL() << "baked";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kImpostorImpossible);
    EXPECT_NE(std::string(failure.what()).find(reaches_in), std::string::npos) << failure.what();
  }
}

// Ten thousand layers and more are refused by the closed form: `why_not` holds the plan to the O(1) sketch.
TEST(ExtremeCells, ThatNeedTenThousandLayersAreRefused) {
  const Box deep{Vec3(-1.0, -1.0, -1000.0), Vec3(1.0, 1.0, 0.0)};
  const ViewCell wide = Box{Vec3(-40.0, -40.0, 2.0), Vec3(40.0, 40.0, 3.0)};
  const double wanted = sketch_impostor(deep, wide, {}, {.max_layers = 1'000'000}).layers;
  ASSERT_GT(wanted, 10'000.0);
  ASSERT_LT(wanted, 1'000'000.0);
  EXPECT_EQ(why_not(deep, wide), "too many layers");
  EXPECT_EQ(why_not(deep, wide, {}, {.max_layers = 10'000}), "too many layers");
  const ImpostorPlan plan = plan_impostor(deep, wide, {}, {.max_layers = 1'000'000});
  ASSERT_TRUE(plan.possible) << plan.why_not;
  EXPECT_NEAR(static_cast<double>(plan.layers.size()), wanted, 0.03 * wanted);
}

TEST(ExtremeTextures, OfOneTexelOnManyLayersShowEachDepth) {
  SmallScene scene;
  for (int i = 0; i < 12; ++i) scene.add_object(rectangle({-0.005, -0.005, -20.0 * i}, {0.01, 0, 0}, {0, 0.01, 0}));
  std::vector<std::uint32_t> objects(12);
  for (std::uint32_t i = 0; i < 12; ++i) objects[i] = i;
  const Box cell{Vec3(-1.0, -1.0, 20.0), Vec3(1.0, 1.0, 22.0)};
  const Impostor impostor = bake_layered(scene.scene, {objects, cell}, {}, {.seal_rims = false});
  EXPECT_EQ(impostor.frame.width, 1U);
  EXPECT_EQ(impostor.frame.height, 1U);
  EXPECT_GT(impostor.layers.size(), 5U);
  EXPECT_EQ(impostor.texel_count(), impostor.quads.size());
  EXPECT_GT(impostor.quads.size(), 5U);  // beside one another as seen from the cell's corners: none may be culled
}

// Wider than an atlas page: cut into quads that fit.
TEST(ExtremeTextures, EightThousandTexelsWideAreCutToFitThePages) {
  SmallScene scene;
  scene.add_object(rectangle({-100.0, -0.2, 0.0}, {200, 0, 0}, {0, 0.4, 0}));
  const Camera camera;
  const double min_distance = 200.0 * camera.focal_px() / 8192.0;  // where the wall takes 8192 texels
  const BakeQuality quality{.max_resolution = 8192};
  const ViewCell cell = shaft_towards_z(0.01, min_distance * (1.0 + 1e-9));
  EXPECT_EQ(why_not(scene.scene.objects[0].bounds, cell), "texture too large");
  Impostor impostor = bake_layered(scene.scene, {{0}, cell}, camera, quality);
  EXPECT_EQ(impostor.frame.width, 8192U);
  std::uint64_t opaque = 0;
  for (std::size_t i = 3; i < impostor.texels.size(); i += 4) opaque += impostor.texels[i] != 0 ? 1 : 0;
  EXPECT_EQ(opaque, std::uint64_t{impostor.frame.width} * impostor.frame.height);
  std::vector<Impostor> impostors;
  impostors.push_back(std::move(impostor));
  const ImpostorSet set = pack_atlas(std::move(impostors));
  for (const Texture& page : set.pages) EXPECT_LE(std::max(page.width, page.height), static_cast<int>(AtlasOptions{}.max_side));
  EXPECT_FALSE(encode_impostor_glb(set).empty());
}

// The camera's distance changes with the field of view, so that the cluster spans the same number of pixels each time.
TEST(ExtremeCameras, OfOneTo150DegreesKeepThePromise) {
  const Cluster cluster;
  for (const double fov_y_deg : {1.0, 10.0, 45.0, 90.0, 120.0, 150.0}) {
    SCOPED_TRACE("field of view " + std::to_string(fov_y_deg));
    Camera camera;
    camera.fov_y_rad = fov_y_deg * kDegree;
    const double distance = 0.5 + camera.focal_px() / 60.0;
    const ViewCell cell = shaft_towards_z(0.15, distance);
    const ImpostorPlan plan = plan_impostor(cluster.bounds(), cell, camera, {});
    ASSERT_TRUE(plan.possible) << plan.why_not;
    EXPECT_GE(plan.frame.width, 50U);
    EXPECT_LE(plan.frame.width, 130U);
    expect_kept(judged(cluster, cell, camera), 100);
  }
}

double log_uniform(Rng& rng, double low, double high) {
  return low * std::pow(high / low, rng.uniform());
}

/// A cell of any size and shape at any distance from a cluster of unit size.
ViewCell any_cell(Rng& rng) {
  const double distance = 0.5 + log_uniform(rng, 1e-4, 1e8), size = log_uniform(rng, 1e-9, 1e3) * distance;
  if (rng.uniform() < 0.5) {
    Shaft shaft = shaft_frame(Vec3(0.0), glm::normalize(test::random_point(rng, {Vec3(-1.0), Vec3(1.0)})));
    shaft.tan_half = {log_uniform(rng, 1e-9, 2.0), rng.uniform() < 0.2 ? 0.0 : log_uniform(rng, 1e-9, 2.0)};
    shaft.min_distance_m = distance;
    return shaft;
  }
  const Vec3 low(rng.uniform(-2.0, 2.0) * size, rng.uniform(-2.0, 2.0) * distance, distance);
  return Box{low, low + size * Vec3(rng.uniform(), log_uniform(rng, 1e-6, 1.0), log_uniform(rng, 1e-6, 1.0))};
}

Camera any_camera(Rng& rng) {
  Camera camera;
  camera.fov_y_rad = rng.uniform(1.0, 150.0) * kDegree;
  camera.width = camera.height = static_cast<int>(log_uniform(rng, 16.0, 8192.0));
  return camera;
}

void expect_sound(const ImpostorPlan& plan, const BakeQuality& quality) {
  EXPECT_LE(std::max(plan.frame.width, plan.frame.height), quality.max_resolution);
  EXPECT_GE(std::min(plan.frame.width, plan.frame.height), 1U);
  EXPECT_TRUE(std::isfinite(glm::length(plan.frame.slope_min)) && plan.frame.slope_step.x > 0.0);
  ASSERT_FALSE(plan.layers.empty());
  for (std::size_t i = 0; i < plan.layers.size(); ++i) {
    const Layer& layer = plan.layers[i];
    ASSERT_TRUE(0.0 < layer.near_m && layer.near_m <= layer.distance_m && layer.distance_m <= layer.far_m);
    ASSERT_TRUE(i == 0 || layer.near_m == plan.layers[i - 1].far_m);
  }
}

// Whatever is asked: a sound plan or a reason, the same by the O(1) sketch but for counts at the very cap; and what is baked is gapless.
TEST(ExtremeCameras, AnyCellAndAnyCameraGetASoundPlanOrAReason) {
  const Cluster cluster;
  Rng rng(41);
  int possible = 0, refused = 0, judged_rays = 0;
  for (int i = 0; i < 4000; ++i) {
    const ViewCell cell = any_cell(rng);
    const Camera camera = any_camera(rng);
    const BakeQuality quality{.alpha_scale = log_uniform(rng, 0.1, 16.0), .texel_scale = log_uniform(rng, 0.1, 16.0)};
    SCOPED_TRACE("case " + std::to_string(i));
    const ImpostorPlan plan = plan_impostor(cluster.bounds(), cell, camera, quality);
    const double unlimited =
        sketch_impostor(cluster.bounds(), cell, camera,
                        {.alpha_scale = quality.alpha_scale, .texel_scale = quality.texel_scale, .max_layers = 4'000'000'000U})
            .layers;
    if (plan.possible) {
      expect_sound(plan, quality);
      EXPECT_NEAR(unlimited, static_cast<double>(plan.layers.size()), 2.0 + 0.03 * unlimited);
    } else {
      EXPECT_STRNE(plan.why_not, "");
      EXPECT_GT(unlimited, 0.97 * quality.max_layers - 2.0);
    }
    ++(plan.possible ? possible : refused);
    const double texels = static_cast<double>(plan.layers.size()) * plan.frame.width * plan.frame.height;
    if (!plan.possible || texels > 3e4 || texels < 30.0) continue;
    const Impostor impostor = bake_layered(cluster.scene, {{0}, cell}, camera, quality);
    const Verdict verdict = test::judge(cluster.surfaces, impostor, std::min(1.5, quality.alpha_scale * camera.pixel_angle_rad()), 4, 5);
    EXPECT_EQ(verdict.gaps, 0);
    judged_rays += verdict.judged;
  }
  EXPECT_GT(possible, 1000);
  EXPECT_GT(refused, 500);
  EXPECT_GT(judged_rays, 100);
}

// Sixteen pixels over 150 degrees: four of them are 105 degrees, sixteen 421, more than any parallax can be.
TEST(ExtremeCameras, AParallaxLimitBeyondAllAnglesIsNone) {
  Camera camera;
  camera.fov_y_rad = 150.0 * kDegree;
  camera.width = camera.height = 16;
  const Cluster cluster;
  for (const double alpha_scale : {4.0, 16.0}) {
    const BakeQuality quality{.alpha_scale = alpha_scale};
    EXPECT_EQ(why_not(cluster.bounds(), shaft_towards_z(0.2, 5.0), camera, quality), "");
    EXPECT_EQ(bake_layered(cluster.scene, {{0}, shaft_towards_z(0.2, 5.0)}, camera, quality).layers.size(), 1U);
  }
}

}  // namespace
}  // namespace standin
