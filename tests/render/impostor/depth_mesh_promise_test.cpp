// The promise of depth meshes: from anywhere in the view cell no gap pixel, and how far a shown point may lie from the original.
#include <gtest/gtest.h>

#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/depth_mesh_judge.h"
#include "tests/render/impostor/house_scene.h"

namespace standin {
namespace {

struct Case {
  std::vector<test::Surface> surfaces;
  Scene scene;
};

Case case_of(const std::vector<test::WorldTriangle>& triangles) {
  Case result;
  std::vector<test::WorldTriangle> stored = triangles;
  for (auto& triangle : stored)
    for (Vec3& corner : triangle) corner = Vec3(glm::vec3(corner));
  test::SmallScene scene;
  scene.add_object(stored);
  result.scene = std::move(scene.scene);
  result.surfaces = test::opaque_surfaces(stored);
  return result;
}

Camera small_camera() {
  Camera camera;
  camera.width = camera.height = 256;
  return camera;
}

DepthMeshImpostor baked(const Case& c, const ViewCell& cell, const DepthMeshQuality& quality = {}) {
  return bake_depth_mesh(c.scene, TexturePyramids(c.scene), {{0}, cell}, small_camera(), {}, quality);
}

void report(const DepthMeshImpostor& impostor, const test::MeshVerdict& verdict) {
  std::vector<double> parallax = verdict.parallax;
  std::sort(parallax.begin(), parallax.end());
  const auto at = [&](double share) { return parallax.empty() ? 0.0 : parallax[static_cast<std::size_t>(share * (parallax.size() - 1))]; };
  std::printf("%u layers, %u meshes, %llu polygons to %llu triangles; %d gaps of %d; parallax ratio median %.2f p99 %.2f worst %.2f\n",
              impostor.summary.layers, impostor.summary.meshes, static_cast<unsigned long long>(impostor.summary.initial_polygons),
              static_cast<unsigned long long>(impostor.summary.triangles), verdict.gaps, verdict.judged, at(0.5), at(0.99), at(1.0));
}

/// No gap; and points of the mesh are as near to the original as half a layer, enlarged by 1.4, allows beyond alpha; nearly all are within.
void expect_kept(const test::MeshVerdict& verdict) {
  EXPECT_EQ(verdict.gaps, 0);
  EXPECT_LE(verdict.worst_parallax, 1.7);
  const auto beyond = std::count_if(verdict.parallax.begin(), verdict.parallax.end(), [](double ratio) { return ratio > 1.0; });
  EXPECT_LE(static_cast<double>(beyond), 0.02 * static_cast<double>(verdict.parallax.size()));
}

TEST(DepthMeshPromise, HoldsForAHouseSeenFromABox) {
  const Case house = case_of(test::house_triangles());
  for (const double distance : {25.0, 50.0, 120.0}) {
    const Box cell{Vec3(-20.0, 1.0, 5.0 + distance), Vec3(20.0, 25.0, 45.0 + distance)};
    const DepthMeshImpostor impostor = baked(house, cell);
    const auto verdict = test::judge_mesh(house.surfaces, impostor, small_camera().pixel_angle_rad(), 4000, 1);
    report(impostor, verdict);
    EXPECT_GT(verdict.judged, 400);
    expect_kept(verdict);
  }
}

TEST(DepthMeshPromise, HoldsForShafts) {
  const Case house = case_of(test::house_triangles());
  for (const Vec3 axis : {Vec3(0.0, 0.2, 1.0), Vec3(0.7, 0.3, 0.6)}) {
    Shaft shaft = shaft_frame(Vec3(0.0, 5.0, -9.0), glm::normalize(axis));
    shaft.tan_half = Vec2(0.2);
    shaft.min_distance_m = 60.0;
    const DepthMeshImpostor impostor = baked(house, shaft);
    const auto verdict = test::judge_mesh(house.surfaces, impostor, small_camera().pixel_angle_rad(), 4000, 2);
    report(impostor, verdict);
    EXPECT_GT(verdict.judged, 400);
    expect_kept(verdict);
  }
}

TEST(DepthMeshPromise, HoldsForLooseTriangles) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Rng rng(seed);
    const Case c = case_of(test::random_triangles(rng, {Vec3(-4.0, -3.0, -5.0), Vec3(4.0, 3.0, 5.0)}, 40));
    Shaft shaft = shaft_frame(Vec3(0.0), glm::normalize(Vec3(0.3, 0.2, 1.0)));
    shaft.tan_half = Vec2(0.05 + 0.05 * static_cast<double>(seed));
    shaft.min_distance_m = 12.0 + 4.0 * static_cast<double>(seed);
    const DepthMeshImpostor impostor = baked(c, shaft);
    const auto verdict = test::judge_mesh(c.surfaces, impostor, small_camera().pixel_angle_rad(), 2000, seed);
    report(impostor, verdict);
    EXPECT_GT(verdict.judged, 100);
    expect_kept(verdict);
  }
}

// The judge finds fault where there is one: with voxels six times as large, borders open.
TEST(DepthMeshPromise, BreaksWithFarTooLargeVoxels) {
  const Case house = case_of(test::house_triangles());
  const Box cell{Vec3(-20.0, 1.0, 30.0), Vec3(20.0, 25.0, 70.0)};
  const DepthMeshImpostor impostor = baked(house, cell, {.enlargement = 6.0});
  const auto verdict = test::judge_mesh(house.surfaces, impostor, small_camera().pixel_angle_rad(), 4000, 1);
  report(impostor, verdict);
  EXPECT_GT(verdict.gaps, 0);
}

}  // namespace
}  // namespace standin
