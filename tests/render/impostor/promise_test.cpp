// The promise: from anywhere in the view cell no gap pixel, and no parallax above alpha. Random scenes, judged by rays; and the same judge
// must find fault with the thesis' own layer set-up and with centre sampling.
#include <gtest/gtest.h>

#include "render/impostor/bake.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin {
namespace {

using test::Verdict;

constexpr Box kObjects{Vec3(-4.0, -3.0, -5.0), Vec3(4.0, 3.0, 5.0)};

struct Case {
  std::vector<test::Surface> surfaces;
  Scene scene;
};

Case random_case(std::uint64_t seed, int count, const Box& box) {
  Rng rng(seed);
  Case result;
  const auto triangles = test::random_triangles(rng, box, count);
  test::SmallScene scene;
  scene.add_object(triangles);
  result.scene = std::move(scene.scene);
  result.surfaces = test::opaque_surfaces(triangles);
  return result;
}

/// Foliage: triangles with a mask of random dots, `repeats` times over each.
Case masked_case(std::uint64_t seed, int count, double repeats, const Texture& mask) {
  Rng rng(seed);
  Case result;
  const auto triangles = test::random_triangles(rng, kObjects, count);
  const std::array<Vec2, 3> uvs{Vec2(0.1, 0.2), Vec2(repeats, 0.0), Vec2(0.3, repeats)};
  Material material = test::SmallScene::white();
  material.alpha_mode = AlphaMode::kMask;
  material.texture = 0;
  test::SmallScene scene;
  scene.scene.textures.push_back(mask);
  scene.add_object(triangles, material, std::vector<std::array<Vec2, 3>>(triangles.size(), uvs));
  result.scene = std::move(scene.scene);
  for (const auto& triangle : triangles) result.surfaces.push_back({triangle, uvs, &mask});
  return result;
}

Texture random_mask(std::uint64_t seed, int width, int height, double opaque) {
  Rng rng(seed, 5);
  Texture mask{"mask", width, height, {}};
  for (int i = 0; i < width * height; ++i)
    for (const int c : {40, 160, 60, rng.uniform() < opaque ? 255 : 0}) mask.rgba.push_back(static_cast<std::uint8_t>(c));
  return mask;
}

ViewCell shaft_cell(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), glm::normalize(Vec3(0.3, 0.2, 1.0)));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

Verdict judged(const Case& c, const ViewCell& cell, const BakeQuality& quality, std::uint64_t seed) {
  Camera camera;
  camera.width = camera.height = 256;
  const Impostor impostor = bake_layered(c.scene, {{0}, cell}, camera, quality);
  const Verdict verdict = test::judge(c.surfaces, impostor, camera.pixel_angle_rad(), 900, seed);
  return verdict;
}

void expect_kept(const Verdict& verdict) {
  EXPECT_GT(verdict.judged, 100);
  EXPECT_GT(verdict.parallax_judged, 100);
  EXPECT_EQ(verdict.gaps, 0);
  EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
}

TEST(Promise, HoldsForShafts) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_kept(judged(random_case(seed, 40, kObjects), shaft_cell(0.05 + 0.05 * seed, 12.0 + 4.0 * seed), {}, seed));
  }
}

TEST(Promise, HoldsForBoxesBesideTheCluster) {
  for (std::uint64_t seed = 11; seed <= 16; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const double shift = static_cast<double>(seed) - 11.0;
    const Box cell{Vec3(-3.0 + 3.0 * shift, -1.0, 20.0), Vec3(1.0 + 3.0 * shift, 1.0, 22.0 + 2.0 * shift)};
    expect_kept(judged(random_case(seed, 40, kObjects), cell, {}, seed));
  }
}

// Coarse texels leave the spacing to the parallax limit, which must then be met and not merely undercut.
TEST(Promise, HoldsWhereTheParallaxLimitBinds) {
  BakeQuality coarse;
  coarse.texel_scale = 6.0;
  double worst = 0.0;
  for (std::uint64_t seed = 21; seed <= 26; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Verdict verdict = judged(random_case(seed, 40, kObjects), shaft_cell(0.1 * (seed - 20.0), 20.0), coarse, seed);
    EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
    worst = std::max(worst, verdict.worst_parallax);
  }
  EXPECT_GT(worst, 0.8);
}

TEST(Promise, HoldsForMaskedSurfaces) {
  int seed = 40, masked_pixels = 0;
  for (const double repeats : {0.5, 3.0, 12.0})
    for (const double opaque : {0.5, 0.9}) {
      SCOPED_TRACE("seed " + std::to_string(++seed));
      const Texture mask = random_mask(static_cast<std::uint64_t>(seed), 13, 32, opaque);
      const Case c = masked_case(static_cast<std::uint64_t>(seed), 60, repeats, mask);
      const Verdict verdict = judged(c, shaft_cell(0.2, 20.0), {}, static_cast<std::uint64_t>(seed));
      EXPECT_EQ(verdict.gaps, 0) << "of " << verdict.judged;
      EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
      masked_pixels += verdict.judged;
    }
  EXPECT_GT(masked_pixels, 200);
}

/// Texels of the image that show something in any layer: what the impostor shows of itself from its reference viewpoint.
std::vector<bool> shown_columns(const Impostor& impostor) {
  const test::DrawnImpostor drawn(impostor);
  std::vector<bool> shown;
  for (std::uint32_t y = 0; y < impostor.frame.height; ++y)
    for (std::uint32_t x = 0; x < impostor.frame.width; ++x) {
      bool any = false;
      for (std::size_t layer = 0; layer < impostor.layers.size(); ++layer) any = any || drawn.texel(layer, x, y)[3] != 0;
      shown.push_back(any);
    }
  return shown;
}

/// Where rays from the reference viewpoint through the texels' centres hit the original.
std::vector<bool> hit_columns(const Case& c, const ImpostorFrame& frame) {
  std::vector<bool> hit;
  for (std::uint32_t y = 0; y < frame.height; ++y)
    for (std::uint32_t x = 0; x < frame.width; ++x) {
      const Vec3 direction = layer_point(frame, 1.0, x + 0.5, y + 0.5) - frame.reference_viewpoint;
      hit.push_back(test::first_hit(c.surfaces, frame.reference_viewpoint, direction).has_value());
    }
  return hit;
}

// Leaves grow by their outlines. Without them an impostor shows, from its reference viewpoint, what rays see and nothing else: no growth at
// all. The price is gaps, and so no promise; and what more is seen through it is
// no longer culled.
TEST(Promise, FuzzyFoliageDoesNotGrowAndPromisesNothing) {
  int gaps = 0, judged_pixels = 0;
  for (std::uint64_t seed = 61; seed <= 64; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Texture mask = random_mask(seed, 13, 32, 0.2);
    const Case c = masked_case(seed, 60, 8.0, mask);
    const ViewCell cell = shaft_cell(0.2, 20.0);
    Camera camera;
    camera.width = camera.height = 256;
    const Impostor strict = bake_layered(c.scene, {{0}, cell}, camera, {});
    const Impostor fuzzy = bake_layered(c.scene, {{0}, cell}, camera, {.fuzzy = true});
    EXPECT_EQ(guarantee_name(strict), "nearest");
    EXPECT_EQ(guarantee_name(fuzzy), "none");
    const auto hit = hit_columns(c, fuzzy.frame), shown = shown_columns(fuzzy), grown = shown_columns(strict);
    EXPECT_EQ(shown, hit);
    const auto hits = std::count(hit.begin(), hit.end(), true), all = std::count(grown.begin(), grown.end(), true);
    EXPECT_GT(all, hits * 5 / 4);
    for (std::size_t i = 0; i < hit.size(); ++i) EXPECT_TRUE(grown[i] || !hit[i]);
    const Verdict verdict = judged(c, cell, {.fuzzy = true}, seed);
    gaps += verdict.gaps;
    judged_pixels += verdict.judged;
  }
  EXPECT_GT(gaps, 0) << "of " << judged_pixels;
}

TEST(Promise, FuzzyChangesNothingWithoutMasks) {
  const Case c = random_case(7, 40, kObjects);
  const ViewCell cell = shaft_cell(0.2, 20.0);
  const Impostor strict = bake_layered(c.scene, {{0}, cell}, Camera{}, {}),
                 fuzzy = bake_layered(c.scene, {{0}, cell}, Camera{}, {.fuzzy = true});
  EXPECT_EQ(guarantee_name(fuzzy), "nearest");
  EXPECT_EQ(fuzzy.texels, strict.texels);
}

TEST(Promise, CentreSamplingBreaksIt) {
  BakeQuality centre;
  centre.supercover = false;
  int gaps = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    gaps += judged(random_case(seed, 40, kObjects), shaft_cell(0.05 + 0.05 * seed, 12.0 + 4.0 * seed), centre, seed).gaps;
  EXPECT_GT(gaps, 0);
}

TEST(Promise, TheThesisOwnLayersBreakIt) {
  BakeQuality thesis;
  thesis.strict = false;
  thesis.texel_scale = 6.0;
  const Box narrow_and_deep{Vec3(-0.1, -0.1, 20.0), Vec3(0.1, 0.1, 70.0)};
  const Case c = random_case(31, 40, kObjects);
  EXPECT_GT(judged(c, narrow_and_deep, thesis, 31).worst_parallax, 1.2);
  thesis.strict = true;
  EXPECT_LE(judged(c, narrow_and_deep, thesis, 31).worst_parallax, 1.0 + 1e-6);
}

}  // namespace
}  // namespace standin
