// The promise: from anywhere in the view cell no gap pixel, and no parallax above alpha. Random scenes, judged by rays; and the same judge
// must find fault with the thesis' own layer set-up and with centre sampling.
#include <gtest/gtest.h>

#include <iostream>

#include "render/impostor/bake.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin {
namespace {

using test::Verdict;

constexpr Box kObjects{Vec3(-4.0, -3.0, -5.0), Vec3(4.0, 3.0, 5.0)};

struct Case {
  std::vector<test::WorldTriangle> triangles;
  Scene scene;
};

Case random_case(std::uint64_t seed, int count, const Box& box) {
  Rng rng(seed);
  Case result;
  result.triangles = test::random_triangles(rng, box, count);
  test::SmallScene scene;
  scene.add_object(result.triangles);
  result.scene = std::move(scene.scene);
  return result;
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
  const Verdict verdict = test::judge(c.triangles, impostor, camera.pixel_angle_rad(), 400, seed);
  if (getenv("V"))
    std::cout << seed << " layers " << impostor.layers.size() << " " << impostor.frame.width << "x" << impostor.frame.height << " quads "
              << impostor.quads.size() << " judged " << verdict.judged << " gaps " << verdict.gaps << " par " << verdict.worst_parallax
              << " of " << verdict.parallax_judged << "\n";
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
