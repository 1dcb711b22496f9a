#include "render/impostor/size_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/texture_pyramid.h"
#include "render/scene/city.h"
#include "render/scene/scene.h"
#include "tests/render/impostor/small_scene.h"
#include "tests/support/scene_builder.h"

namespace standin::test {
namespace {

/// Bound over real bytes of one bake; nothing where no impostor is possible or nothing is seen.
std::optional<double> bound_over_bytes(const Scene& scene, const SizeBound& bound, const TexturePyramids& textures,
                                       const BakeRequest& request, const BakeQuality& quality) {
  Camera camera;
  camera.width = camera.height = 256;
  const double least = bound.texture_bytes(request.objects, request.view_cell, camera, quality);
  try {
    const Impostor impostor = bake_layered(scene, textures, request, camera, quality);
    const auto real = static_cast<double>(texture_bytes(impostor));
    EXPECT_LE(least, real);
    if (real == 0.0) return std::nullopt;
    return least / real;
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kImpostorImpossible) throw;
    return std::nullopt;
  }
}

/// Any cell that does not touch the objects: shafts from their centre, boxes beside them.
ViewCell random_cell(Rng& rng, const Box& objects) {
  const double size = std::max(objects.diagonal(), 1e-3);
  const Vec3 away = glm::normalize(Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-0.7, 0.9), rng.uniform(-1.0, 1.0)) + Vec3(1e-3));
  if (rng.below(2) == 0) {
    Shaft shaft = shaft_frame(objects.centre(), away);
    shaft.tan_half = {rng.uniform(0.0, 0.4), rng.uniform(0.0, 0.2)};
    shaft.min_distance_m = size * std::exp(rng.uniform(-0.5, 4.0));
    return shaft;
  }
  const Vec3 centre = objects.centre() + away * size * std::exp(rng.uniform(0.3, 4.0));
  const Vec3 half(0.1 * size * rng.uniform(), 0.05 * size * rng.uniform(), 0.1 * size * rng.uniform());
  return Box{centre - half, centre + half};
}

BakeQuality random_quality(Rng& rng) {
  BakeQuality quality;
  quality.texel_scale = std::exp(rng.uniform(-0.7, 1.4));
  quality.alpha_scale = std::exp(rng.uniform(-0.3, 1.0));
  quality.fill_ratio = rng.uniform(0.3, 1.0);
  quality.fuzzy = rng.uniform() < 0.3;
  quality.max_layers = 60;
  quality.max_resolution = 400;
  return quality;
}

/// A few objects of one scene, at least one.
std::vector<std::uint32_t> random_cluster(Rng& rng, std::size_t objects, std::size_t most) {
  std::vector<std::uint32_t> ids;
  const auto first = rng.below(objects);
  for (std::size_t i = 0; i < 1 + rng.below(most); ++i) ids.push_back(static_cast<std::uint32_t>((first + i) % objects));
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

struct Tally {
  int bakes = 0;
  int proven = 0;  // bounds above 0
  double greatest = 0.0;

  void add(double ratio) {
    ++bakes;
    proven += ratio > 0.0 ? 1 : 0;
    greatest = std::max(greatest, ratio);
  }
  void print() const { std::printf("%d impostors, %d with a bound, at most %.4f of the bytes\n", bakes, proven, greatest); }
};

void check_clusters(const Scene& scene, Rng& rng, int cases, std::size_t most, Tally& tally) {
  const SizeBound bound(scene);
  const TexturePyramids textures(scene);
  for (int i = 0; i < cases; ++i) {
    BakeRequest request{random_cluster(rng, scene.objects.size(), most), {}};
    Box bounds;
    for (const auto id : request.objects) bounds.extend(scene.objects[id].bounds);
    request.view_cell = random_cell(rng, bounds);
    if (const auto ratio = bound_over_bytes(scene, bound, textures, request, random_quality(rng))) tally.add(*ratio);
  }
}

/// Turned, stretched and mirrored cubes, loose triangles, slivers, masked leaves.
Scene random_scene(Rng& rng) {
  SmallScene small;
  const Box box{Vec3(-3.0), Vec3(3.0)};
  Material leaves = SmallScene::white();
  leaves.alpha_mode = AlphaMode::kMask;
  leaves.base_colour.a = rng.below(2) == 0 ? 0.2F : 1.0F;
  for (int i = 0; i < 3; ++i) small.add_object(random_triangles(rng, box, 1 + static_cast<int>(rng.below(6))));
  small.add_object(random_triangles(rng, box, 3), leaves);
  small.add_object(rectangle(random_point(rng, box), random_point(rng, box), random_point(rng, box)));
  small.add_object({{Vec3(0.0), Vec3(2.0, 0.0, 0.0), Vec3(1.0, 1e-5, 0.0)}, {Vec3(0.0), Vec3(0.0), Vec3(0.0, 1.0, 0.0)}});
  Scene scene = std::move(small.scene);
  const auto cube = add_mesh(scene, make_cube());
  const auto grey = add_material(scene, {});
  for (int i = 0; i < 4; ++i) {
    Mat4 at(1.0);
    for (int column = 0; column < 4; ++column) at[column] += Vec4(random_point(rng, {Vec3(-0.8), Vec3(0.8)}), 0.0);
    at[3] += Vec4(random_point(rng, box), 0.0);
    if (i == 0) at[0] = -at[0];
    add_object(scene, cube, grey, at);
  }
  update_derived(scene);
  return scene;
}

TEST(SizeBound, NeverAboveTheBytesOfSmallScenes) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rng rng(seed);
    check_clusters(random_scene(rng), rng, 15, 4, tally);
  }
  tally.print();
  EXPECT_GT(tally.bakes, 2000);
  EXPECT_GT(tally.proven, 1900);
}

TEST(SizeBound, NeverAboveTheBytesOfACity) {
  const Scene city = make_city({.objects = 60, .triangles = 40000, .seed = 3});
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Rng rng(seed);
    check_clusters(city, rng, 60, 3, tally);
  }
  tally.print();
  EXPECT_GT(tally.bakes, 500);
  EXPECT_GT(tally.proven, 450);
}

double ratio_of(const Scene& scene, const ViewCell& cell) {
  BakeRequest request{{}, cell};
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id) request.objects.push_back(id);
  return bound_over_bytes(scene, SizeBound(scene), TexturePyramids(scene), request, {}).value_or(-1.0);
}

Shaft shaft_from(const Vec3& apex, const Vec3& axis, double distance_m) {
  Shaft shaft = shaft_frame(apex, glm::normalize(axis));
  shaft.tan_half = Vec2(0.02);
  shaft.min_distance_m = distance_m;
  return shaft;
}

TEST(SizeBound, AWallIsNearlyItsBytes) {
  SmallScene wall;
  wall.add_object(rectangle(Vec3(-6.0, 0.0, 0.0), Vec3(12.0, 0.0, 0.0), Vec3(0.0, 8.0, 0.0)));
  EXPECT_GT(ratio_of(wall.scene, shaft_from(Vec3(0.0, 4.0, 0.0), Vec3(0.0, 0.0, 1.0), 40.0)), 0.9);
  EXPECT_GT(ratio_of(wall.scene, Box{Vec3(-1.0, 1.0, 40.0), Vec3(1.0, 2.0, 42.0)}), 0.9);
}

TEST(SizeBound, AHouseAndWhatHidesBehindItCountOnce) {
  Scene scene;
  const auto cube = add_mesh(scene, make_cube());
  const auto grey = add_material(scene, {});
  Mat4 behind(1.0);
  behind[3].z = -2.5;
  add_object(scene, cube, grey);
  update_derived(scene);
  const Shaft cell = shaft_from(Vec3(0.0), Vec3(0.4, 0.3, 1.0), 30.0);
  EXPECT_GT(ratio_of(scene, cell), 0.7);  // three sides that share edges, in one or few layers
  add_object(scene, cube, grey, behind);
  update_derived(scene);
  EXPECT_GT(ratio_of(scene, cell), 0.4);
}

TEST(SizeBound, MasksAndOpenCoverageProveNothing) {
  SmallScene wall;
  Material masked = SmallScene::white();
  masked.alpha_mode = AlphaMode::kMask;
  wall.add_object(rectangle(Vec3(-6.0, 0.0, 0.0), Vec3(12.0, 0.0, 0.0), Vec3(0.0, 8.0, 0.0)), masked);
  const Shaft cell = shaft_from(Vec3(0.0, 4.0, 0.0), Vec3(0.0, 0.0, 1.0), 40.0);
  EXPECT_EQ(SizeBound(wall.scene).texture_bytes(std::vector<std::uint32_t>{0}, cell, {}, {}), 0.0);
  wall.scene.materials[0] = SmallScene::white();
  const SizeBound bound(wall.scene);
  EXPECT_GT(bound.texture_bytes(std::vector<std::uint32_t>{0}, cell, {}, {}), 0.0);
  EXPECT_EQ(bound.texture_bytes(std::vector<std::uint32_t>{0}, cell, {}, {.supercover = false}), 0.0);
  EXPECT_EQ(bound.texture_bytes(std::vector<std::uint32_t>{0}, shaft_from(Vec3(0.0, 4.0, 0.0), Vec3(1.0, 0.0, 0.0), 1.0), {}, {}), 0.0);
}

}  // namespace
}  // namespace standin::test
