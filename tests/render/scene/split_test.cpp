// Splitting changes who draws a triangle, never what is drawn.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "render/scene/mesh_builder.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;

// Every drawn triangle in the world, sorted.
std::vector<Corners> drawn(const Scene& scene) {
  std::vector<Corners> triangles;
  for (const Object& object : scene.objects) {
    for (std::uint32_t p = 0; p < object.part_count; ++p) {
      const Mesh& mesh = scene.meshes[scene.parts[object.first_part + p].mesh];
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Corners corners{};
        for (std::size_t c = 0; c < 3; ++c) {
          const Vec3 at(object.world_from_object * Vec4(Vec3(mesh.positions[mesh.indices[i + c]]), 1.0));
          corners[c] = {at.x, at.y, at.z};
        }
        triangles.push_back(corners);
      }
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

double area(const Scene& scene) {
  double sum = 0.0;
  for (const Object& object : scene.objects) sum += object.area_m2;
  return sum;
}

// One object of two parts (two wavy sheets of 2 * n * n triangles each), `copies` times along x.
Scene sheets(int n, int copies) {
  Scene scene;
  scene.materials.resize(2);
  for (const double height : {0.0, 1.0}) {
    MeshBuilder builder;
    builder.surface([&](double u, double v) { return Vec3(10 * u, height + 0.3 * std::sin(7 * u) * std::cos(5 * v), 10 * v); }, n, n);
    scene.meshes.push_back(builder.finish("sheet"));
  }
  scene.parts = {{0, 0}, {1, 1}};
  for (int i = 0; i < copies; ++i) {
    Object object;
    object.name = "sheets_" + std::to_string(i);
    object.world_from_object = glm::translate(Mat4(1.0), Vec3(16.0 * i, 0.0, 0.0));
    object.part_count = 2;
    scene.objects.push_back(object);
  }
  update_derived(scene);
  return scene;
}

Scene reloaded(const Scene& scene, const LoadOptions& options) {
  const test::TemporaryFolder folder;
  write_scene_glb(scene, folder.path() / "scene.glb");
  return load_scene(folder.path() / "scene.glb", options);
}

TEST(Split, KeepsEveryTriangleAndMeetsTheLimit) {
  const Scene whole = sheets(40, 1);
  LoadOptions options;
  options.split_triangles = 700;
  options.split_extent = 0.0;
  const Scene split = reloaded(whole, options);
  EXPECT_EQ(split.objects.size(), 16U);  // 6,400 halved until 400
  EXPECT_EQ(drawn(split), drawn(whole));
  EXPECT_NEAR(area(split), area(whole), 1e-9 * area(whole));
  for (const Object& object : split.objects) EXPECT_LE(object.triangle_count, 700U);
}

TEST(Split, NamesPiecesAfterTheObject) {
  LoadOptions options;
  options.split_triangles = 4000;
  options.split_extent = 0.0;
  const Scene split = reloaded(sheets(40, 1), options);
  ASSERT_EQ(split.objects.size(), 2U);
  EXPECT_EQ(split.objects[0].name, "sheets_0#0");
  EXPECT_EQ(split.objects[1].name, "sheets_0#1");
  EXPECT_EQ(split.objects[1].gltf_node, "sheets_0");
}

TEST(Split, InstancesShareTheirPieces) {
  LoadOptions options;
  options.split_triangles = 4000;
  options.split_extent = 0.0;
  const Scene whole = sheets(40, 3);
  const Scene split = reloaded(whole, options);
  EXPECT_EQ(split.objects.size(), 6U);
  EXPECT_EQ(split.meshes.size(), 4U);
  EXPECT_EQ(split.objects[0].first_part, split.objects[2].first_part);
  EXPECT_EQ(drawn(split), drawn(whole));
}

TEST(Split, LongObjectsAreCutButNotIntoCrumbs) {
  LoadOptions options;
  options.split_triangles = 0;
  options.split_extent = 0.125;
  const Scene split = reloaded(sheets(40, 1), options);
  EXPECT_GT(split.objects.size(), 4U);
  for (const Object& object : split.objects) EXPECT_GE(object.triangle_count, 400U);
  const double limit_m = 0.125 * split.bounds.diagonal();
  for (const Object& object : split.objects) {
    const Vec3 size = object.bounds.size();
    EXPECT_TRUE(std::max({size.x, size.y, size.z}) <= limit_m || object.triangle_count < 1000);
  }
}

TEST(Split, OnlyInstancesThatAreTooLongAreCut) {
  Scene scene = sheets(40, 2);
  scene.objects[1].world_from_object = glm::scale(Mat4(1.0), Vec3(0.05));
  LoadOptions options;
  options.split_triangles = 0;
  options.split_extent = 0.5;
  const Scene split = reloaded(scene, options);
  EXPECT_EQ(split.objects.back().name, "sheets_1");
  EXPECT_EQ(split.objects.back().triangle_count, 6400U);
  EXPECT_GT(split.objects.size(), 2U);
}

TEST(Split, ZeroMeansNever) {
  LoadOptions options;
  options.split_triangles = 0;
  options.split_extent = 0.0;
  EXPECT_EQ(reloaded(sheets(40, 1), options).objects.size(), 1U);
}

}  // namespace
}  // namespace standin
