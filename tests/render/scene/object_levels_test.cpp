// Levels of detail: simpler, no farther off than they say, whole at seams; shown from where they may be.

#include "render/scene/object_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "render/scene/load.h"
#include "render/scene/mesh_builder.h"
#include "render/scene/simplify_mesh.h"
#include "render/scene/textured_surface.h"
#include "tests/render/scene/glb_maker.h"
#include "tests/render/scene/level_meshes.h"
#include "tests/render/scene/temporary_folder.h"

namespace standin {
namespace {

using test::ball;
using test::kLevelOptions;

Mesh flat_shaded(const Mesh& mesh) {
  Mesh flat;
  flat.name = mesh.name;
  for (const std::uint32_t v : mesh.indices) {
    flat.indices.push_back(static_cast<std::uint32_t>(flat.positions.size()));
    flat.positions.push_back(mesh.positions[v]);
    flat.uvs.push_back(mesh.uvs[v]);
  }
  for (std::size_t i = 0; i < flat.positions.size(); i += 3) {
    const glm::vec3 normal =
        glm::normalize(glm::cross(flat.positions[i + 1] - flat.positions[i], flat.positions[i + 2] - flat.positions[i]));
    flat.normals.insert(flat.normals.end(), 3, normal);
  }
  update_derived(flat);
  return flat;
}

double measured_error(const Mesh& a, const Mesh& b) {
  return TexturedSurface(a, true).deviation_of(b, {}, 1.0).found_m;
}

// One object of `mesh` for each transform.
Scene scene_of(std::vector<Mesh> meshes, const std::vector<Mat4>& places) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = std::move(meshes);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) scene.parts.push_back({m, 0});
  for (const Mat4& place : places) {
    Object object;
    object.name = "object";
    object.world_from_object = place;
    object.part_count = static_cast<std::uint32_t>(scene.parts.size());
    scene.objects.push_back(object);
  }
  update_derived(scene);
  return scene;
}

TEST(Simplified, IsSimplerAndNoFartherOffThanItSays) {
  const Mesh mesh = ball(24);
  const std::vector<SimplifiedMesh> levels = simplified(mesh, {});
  ASSERT_GE(levels.size(), 3U);
  std::size_t triangles = mesh.triangle_count();
  double error_m = 0.0;
  for (const SimplifiedMesh& level : levels) {
    EXPECT_LE(level.mesh.triangle_count(), 0.8 * triangles);
    EXPECT_GT(level.error_m, error_m);
    EXPECT_GE(level.error_m, measured_error(mesh, level.mesh) * (1.0 - 1e-9));
    EXPECT_GE(level.error_found_m, 0.5 * level.error_m);
    EXPECT_EQ(level.mesh.normals.size(), level.mesh.positions.size());
    EXPECT_EQ(level.mesh.uvs.size(), level.mesh.positions.size());
    triangles = level.mesh.triangle_count();
    error_m = level.error_m;
  }
  EXPECT_LT(triangles, mesh.triangle_count() / 8);
}

TEST(Simplified, FlatShadingIsNoObstacle) {
  const Mesh smooth = ball(16);
  const std::vector<SimplifiedMesh> levels = simplified(flat_shaded(smooth), {});
  ASSERT_FALSE(levels.empty());
  EXPECT_LT(levels.back().mesh.triangle_count(), smooth.triangle_count() / 4);
}

TEST(Simplified, LockedBordersStay) {
  MeshBuilder builder;
  builder.surface([](double u, double v) { return Vec3(u, 0.05 * std::sin(12 * u) * std::sin(9 * v), v); }, 20, 20);
  Mesh mesh = builder.finish("sheet");
  update_derived(mesh);
  SimplifyOptions options;
  options.lock_border = true;
  const std::vector<SimplifiedMesh> levels = simplified(mesh, options);
  ASSERT_FALSE(levels.empty());
  const auto border = [](const Mesh& of) {
    std::set<std::array<float, 3>> places;
    for (const glm::vec3& p : of.positions)
      if (p.x == 0.0F || p.x == 1.0F || p.z == 0.0F || p.z == 1.0F) places.insert({p.x, p.y, p.z});
    return places;
  };
  for (const SimplifiedMesh& level : levels) EXPECT_EQ(border(level.mesh), border(mesh));
  EXPECT_LT(border(simplified(mesh, {}).back().mesh).size(), border(mesh).size());
}

TEST(Simplified, FewTrianglesStay) {
  MeshBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(simplified(builder.finish("box"), {}).empty());
}

TEST(ObjectLevels, AreShownFromWhereTheirErrorIsSmall) {
  Scene scene = scene_of({ball(24)}, {Mat4(1.0), glm::scale(Mat4(1.0), Vec3(4.0))});
  const LevelSummary summary = add_object_levels(scene, kLevelOptions, WorkBudget());
  EXPECT_EQ(summary.objects, 2U);
  const Object &small = scene.objects[0], &large = scene.objects[1];
  ASSERT_GE(small.levels.size(), 2U);
  ASSERT_EQ(small.levels.size(), large.levels.size());
  for (std::size_t k = 0; k < small.levels.size(); ++k) {
    const ObjectLevel& level = small.levels[k];
    EXPECT_NEAR(level.least_distance_m * kLevelOptions.error_m_per_m, level.error_m, 1e-12);
    EXPECT_NEAR(large.levels[k].least_distance_m, 4.0 * level.least_distance_m, 1e-9);
    EXPECT_EQ(large.levels[k].first_part, level.first_part);  // instances share their levels
    EXPECT_EQ(level_at(small, level.least_distance_m), k + 1);
    EXPECT_EQ(level_at(small, 0.999 * level.least_distance_m), k);
    EXPECT_EQ(parts_of(small, static_cast<std::uint32_t>(k + 1)).triangle_count, level.triangle_count);
  }
  EXPECT_EQ(level_at(small, 0.0), 0U);
  EXPECT_EQ(parts_of(small, 0).first_part, 0U);
}

// Two parts that meet along an edge: whatever is shown of them, no vertex of the seam is missing on either side.
TEST(ObjectLevels, PartsThatMeetDoNotComeApart) {
  const auto sheet = [](double from, double to) {
    MeshBuilder builder;
    builder.surface(
        [&](double u, double v) {
          const double x = from + u * (to - from);
          return Vec3(x, 0.05 * std::sin(6 * x) * std::sin(9 * v), v);
        },
        20, 20);
    return builder.finish("sheet");
  };
  Scene scene = scene_of({sheet(0.0, 1.0), sheet(1.0, 2.0)}, {Mat4(1.0)});
  add_object_levels(scene, kLevelOptions, WorkBudget());
  ASSERT_FALSE(scene.objects[0].levels.empty());
  for (const ObjectLevel& level : scene.objects[0].levels)
    for (std::uint32_t p = 0; p < 2; ++p) {
      std::set<float> along;
      for (const glm::vec3& at : scene.meshes[scene.parts[level.first_part + p].mesh].positions)
        if (at.x == 1.0F) along.insert(at.z);
      EXPECT_EQ(along.size(), 21U);
    }
}

TEST(ObjectLevels, AreTheSameForAnyNumberOfThreads) {
  Scene one = scene_of({ball(20), ball(13)}, {Mat4(1.0)}), many = one;
  LevelOptions options = kLevelOptions;
  add_object_levels(one, options, WorkBudget());
  options.threads = 4;
  add_object_levels(many, options, WorkBudget());
  ASSERT_EQ(one.meshes.size(), many.meshes.size());
  for (std::size_t m = 0; m < one.meshes.size(); ++m) EXPECT_EQ(one.meshes[m].positions, many.meshes[m].positions);
  ASSERT_EQ(one.objects[0].levels.size(), many.objects[0].levels.size());
  for (std::size_t k = 0; k < one.objects[0].levels.size(); ++k)
    EXPECT_EQ(one.objects[0].levels[k].error_m, many.objects[0].levels[k].error_m);
}

// 1,000 triangles, then 500 and 100: what each saves, and how often, decides.
TEST(LevelsWorthKeeping, AreThoseThatSaveMoreThanTheyWeigh) {
  const auto kept = [](double often, double seldom, double triangles_per_byte) {
    const std::vector<LevelWorth> levels{{500, 3000, often}, {100, 600, seldom}};
    return levels_worth_keeping(1000, levels, triangles_per_byte);
  };
  using Kept = std::vector<std::size_t>;
  EXPECT_EQ(kept(1.0, 1.0, 0.0), (Kept{0, 1}));
  EXPECT_EQ(kept(1.0, 0.0, 0.0), (Kept{0})) << "nobody sees the second";
  EXPECT_EQ(kept(0.0, 1.0, 0.0), (Kept{1})) << "nobody sees the first";
  EXPECT_EQ(kept(0.0, 0.0, 0.0), (Kept{}));
  EXPECT_EQ(kept(1.0, 1.0, 0.2), (Kept{1})) << "the first saves 500 triangles for 3,000 bytes";
  EXPECT_EQ(kept(1.0, 1.0, 0.16), (Kept{0, 1}));
  EXPECT_EQ(kept(1.0, 1.0, 1.6), (Kept{})) << "the second saves 900 for 600";
  EXPECT_TRUE(levels_worth_keeping(1000, {}, 0.0).empty());
}

// A file with levels of its own: a strip of 40 triangles, one of 10, one of 2.
test::GlbMaker strips() {
  test::GlbMaker maker;
  for (const int cells : {20, 5, 1}) {
    std::vector<float> positions;
    std::vector<std::uint32_t> corners;
    for (int i = 0; i <= cells; ++i) {
      const float x = static_cast<float>(i) / static_cast<float>(cells);
      positions.insert(positions.end(), {x, 0.0F, 0.0F, x, 0.0F, 1.0F});
      const auto v = static_cast<std::uint32_t>(2 * i);
      if (i < cells) corners.insert(corners.end(), {v, v + 1, v + 2, v + 1, v + 3, v + 2});
    }
    maker.show(positions, corners);
  }
  maker.json["extensionsUsed"] = {"MSFT_lod"};
  maker.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1, 2};
  return maker;
}

Scene loaded(const test::GlbMaker& maker) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "scene.glb", std::ios::binary) << maker.glb();
  return load_scene(folder.path() / "scene.glb", {});
}

TEST(AuthoredLevels, AreTakenFromTheFile) {
  test::GlbMaker maker = strips();
  maker.json["nodes"][0]["extras"]["MSFT_screencoverage"] = {0.5, 0.04, 0.01};
  maker.json["scenes"][0]["nodes"] = {0, 1, 2};  // listed among the roots, and yet not drawn beside the first
  Scene scene = loaded(maker);
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.triangle_count(), 40U);
  const LevelSummary summary = add_object_levels(scene, kLevelOptions, WorkBudget());
  EXPECT_EQ(summary.authored_objects, 1U);
  EXPECT_EQ(summary.simplified_meshes, 0U);
  const Object& object = scene.objects[0];
  ASSERT_EQ(object.levels.size(), 2U);
  EXPECT_EQ(object.levels[0].triangle_count, 10U);
  EXPECT_EQ(object.levels[1].triangle_count, 2U);
  const double radius_m = 0.5 * std::sqrt(2.0);
  EXPECT_NEAR(object.levels[0].least_distance_m, radius_m * 2.14 / std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(object.levels[1].least_distance_m, radius_m * 2.14 / std::sqrt(0.04), 1e-9);
}

TEST(AuthoredLevels, WithoutCoverageGoByTheirMeasuredError) {
  Scene scene = loaded(strips());
  add_object_levels(scene, kLevelOptions, WorkBudget());
  const Object& object = scene.objects[0];
  ASSERT_FALSE(object.levels.empty());
  EXPECT_EQ(object.levels.back().triangle_count, 2U);  // all lie in the same plane: the simplest may be shown from next to it
  EXPECT_LT(object.levels.back().least_distance_m, 1e-3);
}

// Once for all instances, however they are placed.
TEST(AuthoredLevels, AreMeasuredOnce) {
  test::GlbMaker one = strips(), many = strips();
  for (int i = 0; i < 5; ++i) {
    test::GlbMaker::Json node = many.json["nodes"][0];
    node["translation"] = {0, 0, 3 * i + 3};
    many.json["scenes"][0]["nodes"].push_back(many.json["nodes"].size());
    many.json["nodes"].push_back(node);
    for (int k = 1; k < 3; ++k) {  // a node has one place
      test::GlbMaker::Json level = many.json["nodes"][k];
      level["translation"] = node["translation"];
      many.json["nodes"].push_back(level);
    }
    const std::size_t last = many.json["nodes"].size();
    many.json["nodes"][last - 3]["extensions"]["MSFT_lod"]["ids"] = {last - 2, last - 1};
  }
  Scene first = loaded(one), all = loaded(many);
  ASSERT_EQ(all.objects.size(), 6U);
  LevelOptions options = kLevelOptions;
  const LevelSummary of_one = add_object_levels(first, options, WorkBudget());
  options.threads = 3;
  const LevelSummary of_all = add_object_levels(all, options, WorkBudget());
  EXPECT_GT(of_one.pieces, 0U);
  EXPECT_EQ(of_all.pieces, of_one.pieces);
  for (const Object& object : all.objects) {
    ASSERT_EQ(object.levels.size(), first.objects[0].levels.size());
    EXPECT_NEAR(object.levels[0].error_m, first.objects[0].levels[0].error_m, 1e-12);
  }
}

TEST(AuthoredLevels, ElsewhereAreDroppedAndNoted) {
  test::GlbMaker maker = strips();
  maker.json["nodes"][2]["translation"] = {0, 5, 0};
  const Scene scene = loaded(maker);
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(scene.objects[0].levels.size(), 1U);
  EXPECT_TRUE(std::ranges::any_of(scene.notes, [](const LoadNote& note) { return note.what == "levels of detail"; }));
}

TEST(AuthoredLevels, RequiredIsNoReasonToRefuse) {
  test::GlbMaker maker = strips();
  maker.json["extensionsRequired"] = {"MSFT_lod"};
  EXPECT_EQ(loaded(maker).objects.size(), 1U);
}

}  // namespace
}  // namespace standin
