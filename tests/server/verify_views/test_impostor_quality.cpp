// One impostor from scene to file to verdict: the promise is kept at nearest sampling, and bakes that break it are found out.
#include <gtest/gtest.h>

#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/impostor/impostor_glb.h"
#include "server/verify/impostor_quality.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

constexpr Box kObjects{Vec3(-4.0, -3.0, -5.0), Vec3(4.0, 3.0, 5.0)};
constexpr std::size_t kBilinear = 1, kMipmapped = 2;

class ImpostorQualityTest : public testing::Test {
 protected:
  ImpostorQualityTest() { camera.width = camera.height = 128; }

  static Scene random_scene(std::uint64_t seed) {
    Rng rng(seed);
    test::SmallScene scene;
    Material material = test::SmallScene::white();
    material.base_colour = {0.8F, 0.2F, 0.1F, 1.0F};
    scene.add_object(test::random_triangles(rng, kObjects, 40), material);
    update_derived(scene.scene);
    return std::move(scene.scene);
  }
  static ViewCell shaft() {
    Shaft shaft = shaft_frame(Vec3(0.0), glm::normalize(Vec3(0.3, 0.2, 1.0)));
    shaft.tan_half = Vec2(0.2);
    shaft.min_distance_m = 16.0;
    return shaft;
  }
  [[nodiscard]] ImpostorQuality judge(const Scene& scene, const Impostor& impostor, int threads = 2) const {
    return judge_quality(scene, impostor, encode_impostor_glb(pack_atlas({impostor})), camera, camera.pixel_angle_rad(),
                         {.views = 12, .seed = 3, .threads = threads}, {});
  }

  Camera camera;
};

TEST_F(ImpostorQualityTest, ThePromiseIsKeptOnTheFile) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = random_scene(seed);
    const ImpostorQuality quality = judge(scene, bake_layered(scene, {{0}, shaft()}, camera, {}));
    const ImpostorJudgement& nearest = quality.by_sampling[0];
    EXPECT_EQ(nearest.views, 12U);
    EXPECT_GT(nearest.pixels, 1000U);
    EXPECT_EQ(nearest.gap_pixels, 0U);
    EXPECT_LE(nearest.max_parallax_ratio, 1.0 + 1e-6);
    EXPECT_GT(nearest.max_parallax_ratio, 0.1);
    EXPECT_GT(*nearest.bloat_px(), 0.1);
    EXPECT_LT(*nearest.bloat_px(), 1.5) << "a texel is a pixel, coverage is closed";
    EXPECT_LT(quality.over_views->mean_flip, 0.5);
    EXPECT_GT(quality.at_reference->mean_flip, 0.0);
    EXPECT_LE(*quality.by_sampling[kBilinear].bloat_px(), *nearest.bloat_px() + 0.05) << "filtering rounds corners off";
  }
}

TEST_F(ImpostorQualityTest, CentreSamplingLeavesGaps) {
  BakeQuality centre;
  centre.supercover = false;
  std::uint64_t gaps = 0;
  double bloat = 0.0, closed_bloat = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = random_scene(seed);
    const ImpostorQuality quality = judge(scene, bake_layered(scene, {{0}, shaft()}, camera, centre));
    gaps += quality.by_sampling[0].gap_pixels;
    bloat += *quality.by_sampling[0].bloat_px();
    closed_bloat += *judge(scene, bake_layered(scene, {{0}, shaft()}, camera, {})).by_sampling[0].bloat_px();
  }
  EXPECT_GT(gaps, 0U);
  EXPECT_LT(bloat, 0.7 * closed_bloat) << "what closed coverage costs";
}

TEST_F(ImpostorQualityTest, TheThesisOwnLayersMoveTooFar) {
  BakeQuality thesis;
  thesis.strict = false;
  thesis.texel_scale = 6.0;
  const Scene scene = random_scene(31);
  const Box narrow_and_deep{Vec3(-0.1, -0.1, 20.0), Vec3(0.1, 0.1, 70.0)};
  EXPECT_GT(judge(scene, bake_layered(scene, {{0}, narrow_and_deep}, camera, thesis)).by_sampling[0].max_parallax_ratio, 1.2);
  thesis.strict = true;
  EXPECT_LE(judge(scene, bake_layered(scene, {{0}, narrow_and_deep}, camera, thesis)).by_sampling[0].max_parallax_ratio, 1.0 + 1e-6);
}

// The same triangles, but nobody says that they lie on layers: read back, drawn and judged as a mesh.
TEST_F(ImpostorQualityTest, AMeshOfTheSameTrianglesIsAsGood) {
  const Scene scene = random_scene(2);
  const Impostor layered = bake_layered(scene, {{0}, shaft()}, camera, {});
  Impostor mesh = layered;
  mesh.technique = Technique::kDepthMesh;
  mesh.mesh = textured_mesh(layered);
  mesh.quads.clear();
  const ImpostorQuality of_layers = judge(scene, layered), of_mesh = judge(scene, mesh);
  for (std::size_t i = 0; i < kAlphaSamplings.size(); ++i) {
    EXPECT_EQ(of_mesh.by_sampling[i].shown_pixels, of_layers.by_sampling[i].shown_pixels) << i;
    EXPECT_EQ(of_mesh.by_sampling[i].excess_pixels, of_layers.by_sampling[i].excess_pixels) << i;
  }
  EXPECT_EQ(of_mesh.by_sampling[0].gap_pixels, 0U);
  EXPECT_EQ(of_mesh.over_views->mean_flip, of_layers.over_views->mean_flip);
}

TEST_F(ImpostorQualityTest, AnErasedPageIsAllGapAndAllError) {
  const Scene scene = random_scene(1);
  const Impostor impostor = bake_layered(scene, {{0}, shaft()}, camera, {});
  ImpostorSet erased = pack_atlas({impostor});
  for (auto& page : erased.pages)
    for (std::size_t i = 3; i < page.rgba.size(); i += 4) page.rgba[i] = 0;
  const ImpostorQuality quality = judge_quality(scene, impostor, encode_impostor_glb(erased), camera, camera.pixel_angle_rad(),
                                                {.views = 8, .seed = 3, .threads = 1}, {});
  for (const auto& judgement : quality.by_sampling) EXPECT_EQ(judgement.gap_pixels, judgement.pixels);
  EXPECT_GT(quality.over_views->mean_error, 0.2);
  EXPECT_GT(quality.over_views->mean_flip, 2.0 * judge(scene, impostor).over_views->mean_flip);
}

TEST_F(ImpostorQualityTest, DoesNotDependOnThreads) {
  const Scene scene = random_scene(3);
  const Impostor impostor = bake_layered(scene, {{0}, shaft()}, camera, {});
  EXPECT_EQ(quality_json(judge(scene, impostor, 1)), quality_json(judge(scene, impostor, 3)));
}

// Minified four times, leaves of a texel or two melt into their transparent neighbours: what mipmapped sampling loses must be seen here.
TEST_F(ImpostorQualityTest, MipmapsOpenGapsWhereTexelsAreFine) {
  BakeQuality fine;
  fine.texel_scale = 0.25;
  fine.max_layers = 2000;
  const Scene scene = random_scene(2);
  const ImpostorQuality quality = judge(scene, bake_layered(scene, {{0}, shaft()}, camera, fine));
  EXPECT_EQ(quality.by_sampling[0].gap_pixels, 0U);
  EXPECT_GT(quality.by_sampling[kMipmapped].gap_pixels, 0U);
}

}  // namespace
}  // namespace standin
