// Errors of levels: true in the world whatever the transform, whatever the mesh; and a level that is farther off than stated is found.

#include "render/scene/level_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "render/scene/import.h"
#include "render/scene/simplify_mesh.h"
#include "tests/render/scene/level_meshes.h"

namespace standin {
namespace {

using test::ball;
using test::kLevelOptions;
using test::scene_of_placed;
using test::sheet;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> faults(const Scene& scene) {
  std::vector<std::string> sentences;
  for (const LevelFault& fault : level_faults(scene, kLevelOptions, WorkBudget())) sentences.push_back(fault.sentence);
  return sentences;
}

Surface in_world(const Scene& scene, std::uint32_t first_part, const Mat4& world_from_object) {
  Surface surface = surface_of_parts(scene, {first_part, 1});
  for (SurfacePoint& point : surface.points) point.place = Vec3(world_from_object * Vec4(point.place, 1.0));
  return surface;
}

double error_in_world(const Scene& scene, const Object& object, const ObjectLevel& level) {
  const Surface own = in_world(scene, object.first_part, object.world_from_object);
  const Surface shown = in_world(scene, level.first_part, object.world_from_object);
  DeviationLimits limits;
  limits.pieces = 20 * own.triangles.size();
  return std::max(deviation(own, SurfaceTree(shown), limits).found_m, deviation(shown, SurfaceTree(own), limits).found_m);
}

TEST(LevelErrors, HoldInTheWorldForMirroredAndUnevenlyStretchedInstances) {
  const Mat4 turned = glm::rotate(Mat4(1.0), 0.9, glm::normalize(Vec3(3.0, -1.0, 2.0)));
  const std::vector<Mat4> transforms{glm::scale(Mat4(1.0), Vec3(-1.0, 1.0, 1.0)), turned * glm::scale(Mat4(1.0), Vec3(0.1, 7.0, 1.0)),
                                     glm::scale(turned, Vec3(1.0, -0.01, 30.0)) * turned};
  std::vector<std::pair<std::uint32_t, Mat4>> places;
  for (const Mat4& transform : transforms) places.emplace_back(0, glm::translate(Mat4(1.0), Vec3(200.0 * places.size(), 0, 0)) * transform);
  Scene scene = scene_of_placed({ball(20)}, places);
  add_object_levels(scene, kLevelOptions, WorkBudget());
  for (const Object& object : scene.objects) {
    ASSERT_FALSE(object.levels.empty());
    for (const ObjectLevel& level : object.levels) EXPECT_LE(error_in_world(scene, object, level), level.error_m * (1.0 + 1e-9));
  }
  EXPECT_THAT(faults(scene), IsEmpty());
}

TEST(LevelErrors, StatedTooSmallAreFound) {
  Scene scene = scene_of_placed({ball(20)}, {{0, Mat4(1.0)}});
  add_object_levels(scene, kLevelOptions, WorkBudget());
  ObjectLevel& level = scene.objects[0].levels[0];
  level.error_m *= 0.5;
  level.least_distance_m *= 0.5;
  EXPECT_THAT(faults(scene), ElementsAre(HasSubstr("object 0: level 1: its surface lies within")));
}

TEST(LevelErrors, ShownFromTooNearAreFound) {
  Scene scene = scene_of_placed({ball(20)}, {{0, Mat4(1.0)}});
  add_object_levels(scene, kLevelOptions, WorkBudget());
  scene.objects[0].levels[1].least_distance_m *= 0.9;
  EXPECT_THAT(faults(scene), ElementsAre(HasSubstr("object 0: level 2: is shown from")));
}

// The surface is where it was, but for one triangle that is gone; or its picture slips by a tenth of a metre.
TEST(LevelErrors, AnotherSurfaceUnderTheSameNameIsFound) {
  Scene good = scene_of_placed({sheet()}, {{0, Mat4(1.0)}});
  add_object_levels(good, kLevelOptions, WorkBudget());
  const auto shown = [](Scene& scene) -> Mesh& { return scene.meshes[scene.parts[scene.objects[0].levels[0].first_part].mesh]; };
  ASSERT_THAT(faults(good), IsEmpty());
  Scene holed = good;
  shown(holed).indices.resize(shown(holed).indices.size() - 3);
  EXPECT_THAT(faults(holed), ElementsAre(HasSubstr("level 1: its surface")));
  Scene slipped = good;
  for (glm::vec2& uv : shown(slipped).uvs) uv.x += 0.1F;
  EXPECT_THAT(faults(slipped), ElementsAre(HasSubstr("level 1: its surface")));
}

TEST(LevelErrors, AnAuthorsCoverageDecidesOrNobodyDoes) {
  Scene scene = scene_of_placed({ball(20), ball(5)}, {{0, Mat4(1.0)}});
  const std::uint64_t triangles = scene.meshes[1].triangle_count();
  scene.objects[0].levels = {{1, 1, triangles, -1.0, 0.04, coverage_distance_m(scene.objects[0], 0.04, kLevelOptions)}};
  EXPECT_THAT(faults(scene), IsEmpty());
  scene.objects[0].levels[0].least_distance_m *= 0.5;
  EXPECT_THAT(faults(scene), ElementsAre(HasSubstr("is shown from")));
  scene.objects[0].levels[0].screen_coverage = -1.0;
  EXPECT_THAT(faults(scene), ElementsAre(HasSubstr("states no error")));
}

// A soup of triangles: slivers, vertices on top of each other, texture coordinates out of all proportion, and sizes where floats end.
Mesh hostile(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> one(0.0, 1.0);
  const auto coordinate = [&] { return one(random) < 0.1 ? -0.0 : (one(random) < 0.3 ? 1e-6 : 1.0) * (one(random) - 0.5); };
  Mesh mesh;
  const int n = 12;
  for (int i = 0; i < n * n; ++i) {
    const double x = i % n, y = i / n;
    mesh.positions.emplace_back(size * (x + 0.2 * coordinate()), size * 1e-7 * coordinate(), size * (y + 0.2 * coordinate()));
    mesh.uvs.emplace_back(one(random) < 0.05 ? 1e30 : x / n, one(random) < 0.05 ? 0.0 : y / n);
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = i * n + j, b = a + 1, c = a + n, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, c, b, d, c});
      if (one(random) < 0.1) mesh.indices.insert(mesh.indices.end(), {a, a, b, a, b, static_cast<std::uint32_t>(random() % (n * n))});
    }
  return mesh;
}

TEST(LevelErrors, HoldForHostileMeshes) {
  std::mt19937 random(7);
  std::size_t levels = 0;
  for (const double size : {1e-18, 1e-3, 1.0, 1e6, 1e17})
    for (int trial = 0; trial < 4; ++trial) {
      Scene scene;
      Mesh mesh = hostile(random, size);
      ASSERT_TRUE(clean(mesh, scene));
      update_derived(mesh);
      scene = scene_of_placed({mesh}, {{0, Mat4(1.0)}});
      add_object_levels(scene, kLevelOptions, WorkBudget());
      for (const ObjectLevel& level : scene.objects[0].levels) {
        ++levels;
        EXPECT_TRUE(std::isfinite(level.error_m) && level.error_m >= 0.0) << size;
        EXPECT_LE(error_in_world(scene, scene.objects[0], level), level.error_m * (1.0 + 1e-9)) << size;
      }
      EXPECT_THAT(faults(scene), IsEmpty()) << size;
    }
  EXPECT_GT(levels, 10U);
}

// The middle of a sheet is at x = 0 to its right and at x = -0 to its left. Were these two places, a crack could open between the halves.
Mesh sheet_of_two_zeros() {
  const Mesh whole = sheet(-0.5);
  Mesh mesh;
  for (std::size_t i = 0; i < whole.indices.size(); i += 3) {
    float sum = 0.0F;
    for (std::size_t c = 0; c < 3; ++c) sum += whole.positions[whole.indices[i + c]].x;
    for (std::size_t c = 0; c < 3; ++c) {
      glm::vec3 p = whole.positions[whole.indices[i + c]];
      if (std::abs(p.x) < 1e-6F) p.x = sum < 0.0F ? -0.0F : 0.0F;
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(p);
      mesh.normals.push_back(whole.normals[whole.indices[i + c]]);
    }
  }
  update_derived(mesh);
  return mesh;
}

/// Edges of one triangle alone with an end inside the sheet.
std::size_t cracks(const Mesh& mesh) {
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> edges;
  const auto place = [&](std::size_t i) {
    const glm::vec3 p = mesh.positions[mesh.indices[i]] + 0.0F;
    return Place{p.x, p.y, p.z};
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax(place(i + c), place(i + (c + 1) % 3));
      ++edges[{a, b}];
    }
  const auto inside = [](const Place& p) { return std::abs(p[0]) < 0.4999F && p[2] > 1e-4F && p[2] < 0.9999F; };
  return static_cast<std::size_t>(std::ranges::count_if(
      edges, [&](const auto& edge) { return edge.second == 1 && (inside(edge.first.first) || inside(edge.first.second)); }));
}

TEST(Simplified, MinusZeroIsZero) {
  const Mesh mesh = sheet_of_two_zeros();
  ASSERT_EQ(cracks(mesh), 0U);
  const std::vector<SimplifiedMesh> levels = simplified(mesh, {});
  ASSERT_FALSE(levels.empty());
  for (const SimplifiedMesh& level : levels) EXPECT_EQ(cracks(level.mesh), 0U);
}

}  // namespace
}  // namespace standin
