// LOD-sprites on surfaces of known shape: how coarse the mesh becomes, what it shows, and the error criterion itself.
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/impostor/bake_lod_sprite.h"
#include "render/impostor/sprite_contraction.h"
#include "render/impostor/sprite_error.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

using Triangle = std::array<Vec3, 3>;

ViewCell shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

Impostor baked(const Scene& scene, const ViewCell& cell, const BakeQuality& quality = {}) {
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) objects.push_back(i);
  return bake_lod_sprite(scene, TexturePyramids(scene), {objects, cell}, Camera{}, quality);
}

/// A square of `side` metres in the plane z = 0, of n x n pieces with the height z(x, y).
template <class Height>
std::vector<test::WorldTriangle> terrain(double side, int n, const Height& height) {
  std::vector<test::WorldTriangle> triangles;
  const auto at = [&](int i, int j) {
    const double x = side * (static_cast<double>(i) / n - 0.5), y = side * (static_cast<double>(j) / n - 0.5);
    return Vec3(glm::vec3(Vec3(x, y, height(x, y))));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return triangles;
}

Material coloured(const glm::vec4& colour) {
  Material material = test::SmallScene::white();
  material.base_colour = colour;
  return material;
}

// v1 at the origin sees C at (0, 0, -10); the mesh lies at depth 12. From (3, 0, 0) C is at atan(3 / 10) and C' at atan(3 / 12) beside -z.
TEST(SpriteError, IsTheAngleBetweenAPointAndItsPlaceOnTheMesh) {
  const Vec3 c(0, 0, -10), shown(0, 0, -12);
  EXPECT_NEAR(apparent_angle(Vec3(3, 0, 0), c, shown), std::atan(0.3) - std::atan(0.25), 1e-15);
  EXPECT_EQ(apparent_angle(Vec3(0.0), c, shown), 0.0);
  const std::vector<Vec3> viewpoints{Vec3(0.0), Vec3(3, 0, 0), Vec3(-6, 0, 0)};
  EXPECT_NEAR(apparent_angle(viewpoints, c, shown), std::atan(0.6) - std::atan(0.5), 1e-15);

  const std::vector<Triangle> coarse{{Vec3(-20, -20, -12), Vec3(20, -20, -12), Vec3(0, 40, -12)}};
  const SpriteError error(coarse, Vec3(0, 0, -1), viewpoints);
  const double angle = std::atan(0.6) - std::atan(0.5);
  EXPECT_FALSE(error.within(std::vector<Vec3>{c}, 0.999 * angle));
  EXPECT_TRUE(error.within(std::vector<Vec3>{c}, 1.001 * angle));
}

TEST(SpriteError, SmallAnglesAreStable) {
  EXPECT_NEAR(apparent_angle(Vec3(0.0), Vec3(0, 0, -100), Vec3(1e-7, 0, -100)) / 1e-9, 1.0, 1e-9);
}

TEST(SpriteError, BesideTheMeshTheNearestPointCounts) {
  const std::vector<Triangle> coarse{{Vec3(-1, -1, -10), Vec3(1, -1, -10), Vec3(0, 1, -10)}};
  const std::vector<Vec3> viewpoints{Vec3(0.0)};
  const SpriteError error(coarse, Vec3(0, 0, -1), viewpoints);
  const std::vector<Vec3> above{Vec3(0, 1.1, -10)};
  const double angle = std::atan(0.11) - std::atan(0.1);
  EXPECT_FALSE(error.within(above, 0.99 * angle));
  EXPECT_TRUE(error.within(above, 1.01 * angle));
}

TEST(LodSprite, APlaneOfManyTrianglesIsTwo) {
  test::SmallScene scene;
  scene.add_object(terrain(8.0, 24, [](double x, double) { return 0.5 * x; }));
  const Impostor impostor = baked(scene.scene, shaft_towards_z(0.2, 30.0));
  EXPECT_EQ(impostor.mesh.triangle_count(), 2U);
  EXPECT_EQ(guarantee_name(impostor), "none");
}

// A dome needs more triangles the nearer it is; and the criterion holds for every vertex of it.
TEST(LodSprite, TheMeshIsAsCoarseAsTheCriterionAllows) {
  test::SmallScene scene;
  scene.add_object(terrain(8.0, 32, [](double x, double y) { return 2.0 - (x * x + y * y) / 16.0; }));
  const Mesh& dome = scene.scene.meshes[0];
  std::size_t last = dome.triangle_count();
  for (const double distance : {30.0, 90.0, 270.0}) {
    const ViewCell cell = shaft_towards_z(0.2, distance);
    const Impostor impostor = baked(scene.scene, cell);
    EXPECT_LT(impostor.mesh.triangle_count(), last);
    last = impostor.mesh.triangle_count();
    std::vector<Triangle> coarse;
    for (const Chart& chart : impostor.mesh.charts)
      for (std::uint32_t i = chart.first_index; i < chart.first_index + chart.index_count; i += 3) {
        const auto at = [&](std::uint32_t k) { return impostor.mesh.vertices[chart.first_vertex + impostor.mesh.indices[i + k]].offset; };
        coarse.push_back({at(0), at(1), at(2)});
      }
    std::vector<Vec3> points, viewpoints = corner_viewpoints(cell, impostor.frame.reference_viewpoint);
    for (const glm::vec3& position : dome.positions) points.push_back(Vec3(position) - impostor.frame.reference_viewpoint);
    EXPECT_TRUE(SpriteError(coarse, impostor.frame.forward, viewpoints).within(points, 1.001 * Camera{}.pixel_angle_rad()));
  }
}

TEST(LodSprite, BacksThatNobodyFacesAreDroppedUnlessTwoSided) {
  for (const bool double_sided : {false, true}) {
    test::SmallScene scene;
    Material material = coloured({1, 1, 1, 1});
    material.double_sided = double_sided;
    scene.add_object(test::rectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), material);   // faces +z, the viewer
    scene.add_object(test::rectangle({-2, -2, -3}, {0, 4, 0}, {4, 0, 0}), material);  // faces -z
    EXPECT_EQ(baked(scene.scene, shaft_towards_z(0.2, 30.0)).mesh.triangle_count(), double_sided ? 4U : 2U);
  }
}

// A red board before a green wall: seen from the reference viewpoint the wall's middle is hidden, and is green all the same.
TEST(LodSprite, WhatTheReferenceViewpointDoesNotSeeHasItsOwnColour) {
  test::SmallScene scene;
  scene.add_object(test::rectangle({-4, -4, -6}, {8, 0, 0}, {0, 8, 0}), coloured({0, 1, 0, 1}));
  scene.add_object(test::rectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), coloured({1, 0, 0, 1}));
  const Impostor impostor = baked(scene.scene, shaft_towards_z(0.2, 30.0));
  const TexturedMesh& mesh = impostor.mesh;
  std::size_t boards = 0, walls = 0, first_texel = 0;
  for (const Chart& chart : mesh.charts) {
    for (std::uint32_t i = chart.first_index; i < chart.first_index + chart.index_count; i += 3) {
      Vec2 low(1e9), high(-1e9);
      bool wall = false;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const ImpostorVertex& corner = mesh.vertices[chart.first_vertex + mesh.indices[i + k]];
        wall = impostor.frame.reference_viewpoint.z - glm::dot(corner.offset, impostor.frame.forward) < -3.0;
        low = glm::min(low, corner.texel);
        high = glm::max(high, corner.texel);
      }
      ++(wall ? walls : boards);
      // All opaque texels that the triangle's box in the chart holds.
      for (auto y = static_cast<std::uint32_t>(low.y); y < std::max(high.y, low.y + 0.5); ++y)
        for (auto x = static_cast<std::uint32_t>(low.x); x < std::max(high.x, low.x + 0.5); ++x) {
          const std::size_t at = 4 * (first_texel + std::size_t{y} * chart.width + x);
          if (impostor.texels[at + 3] == 0) continue;
          EXPECT_EQ(impostor.texels[at + (wall ? 1 : 0)], 255) << (wall ? "wall" : "board");
        }
    }
    first_texel += std::size_t{chart.width} * chart.height;
  }
  EXPECT_GE(boards, 2U);
  EXPECT_GE(walls, 2U);
}

// Stripes finer than the coarse mesh come from the image: on a bumpy sheet that becomes flat at this distance.
TEST(LodSprite, TheImageIsProjectedOntoTheCoarseMesh) {
  test::SmallScene scene;
  const auto bumps = [](double x, double y) { return 0.01 * std::sin(9.0 * x) * std::sin(9.0 * y); };
  for (const double sign : {-1.0, 1.0}) {  // left half red, right half green
    auto half = terrain(8.0, 40, bumps);
    std::erase_if(half, [&](const test::WorldTriangle& t) { return sign * (t[0].x + t[1].x + t[2].x) < 0.0; });
    scene.add_object(half, coloured(sign < 0.0 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 1, 0, 1)));
  }
  const Impostor impostor = baked(scene.scene, shaft_towards_z(0.2, 40.0));
  EXPECT_LE(impostor.mesh.triangle_count(), 16U);
  std::size_t red = 0, green = 0;
  for (std::size_t i = 0; i < impostor.texels.size(); i += 4) {
    red += impostor.texels[i] == 255 ? 1 : 0;
    green += impostor.texels[i + 1] == 255 ? 1 : 0;
  }
  const double image = impostor.frame.width * impostor.frame.height;
  EXPECT_NEAR(static_cast<double>(red) / image, 0.5, 0.06);
  EXPECT_NEAR(static_cast<double>(green) / image, 0.5, 0.06);
}

// A board before a smaller one, close behind it: nobody in the shaft looks around the edge. The farther behind, the more of it is seen.
TEST(LodSprite, WhatNobodySeesIsLeftOut) {
  for (const double behind : {1.0, 40.0}) {
    test::SmallScene scene;
    scene.add_object(test::rectangle({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}));
    scene.add_object(test::rectangle({-2, -2, -behind}, {4, 0, 0}, {0, 4, 0}));
    EXPECT_EQ(baked(scene.scene, shaft_towards_z(0.2, 30.0)).mesh.triangle_count(), behind < 2.0 ? 2U : 4U);
  }
}

// Single-sided boards hide only where they face: the one before is culled by a device for whoever looks at the one behind.
TEST(LodSprite, BacksHideNothing) {
  test::SmallScene scene;
  Material material = coloured({1, 1, 1, 1});
  material.double_sided = false;
  scene.add_object(test::rectangle({-4, -4, 0}, {0, 8, 0}, {8, 0, 0}), material);   // faces -z
  scene.add_object(test::rectangle({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), material);  // faces +z, the viewer
  EXPECT_EQ(baked(scene.scene, shaft_towards_z(0.2, 30.0)).mesh.triangle_count(), 2U);
}

// Two boards at the back of each other: near viewers are between their planes, only those far off see the upper one's face.
TEST(LodSprite, WhatOnlyFarViewersSeeIsStillAnImpostor) {
  test::SmallScene scene;
  Material material = coloured({1, 1, 1, 1});
  material.double_sided = false;
  scene.add_object(test::rectangle({-4, 5, 4}, {8, 0, 0}, {0, 0, -8}), material);   // faces +y
  scene.add_object(test::rectangle({-4, -5, -4}, {8, 0, 0}, {0, 0, 8}), material);  // faces -y
  Shaft shaft = shaft_frame(Vec3(0.0), glm::normalize(Vec3(0, 0.02, 1)));
  shaft.tan_half = Vec2(0.001);
  shaft.min_distance_m = 40.0;
  EXPECT_GT(baked(scene.scene, shaft).mesh.triangle_count(), 0U);
}

TEST(LodSprite, PlainTrianglesOfOneColourShareATexel) {
  test::SmallScene scene;
  for (int i = 0; i < 6; ++i)
    scene.add_object(test::rectangle({4.0 * i, 0, 0}, {2, 0, 0}, {0, 8, 0}),
                     coloured(i % 2 == 0 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 0, 1, 1)));
  const Impostor impostor = baked(scene.scene, shaft_towards_z(0.2, 60.0));
  EXPECT_EQ(impostor.mesh.triangle_count(), 12U);
  ASSERT_EQ(impostor.mesh.charts.size(), 1U);
  EXPECT_EQ(impostor.texel_count(), 2U);
}

TEST(LodSprite, MaskedSurfacesAreRefused) {
  test::SmallScene scene;
  scene.add_object(test::rectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}));
  Material leaf = test::SmallScene::white();
  leaf.alpha_mode = AlphaMode::kMask;
  scene.add_object(test::rectangle({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}), leaf);
  try {
    static_cast<void>(baked(scene.scene, shaft_towards_z(0.2, 30.0)));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kImpostorImpossible);
    EXPECT_NE(std::string(failure.what()).find("object 1 has masked surfaces"), std::string::npos) << failure.what();
  }
}

TEST(SpriteContraction, ALoosePartThatAnotherShowsIsTakenAway) {
  SpriteMesh mesh;
  std::vector<Vec3> points;
  const auto add = [&](const Triangle& triangle) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    for (const Vec3& corner : triangle) {
      mesh.vertices.push_back(corner);
      points.push_back(corner);
    }
  };
  add({Vec3(-5, -5, -100), Vec3(5, -5, -100), Vec3(0, 5, -100)});
  add({Vec3(-0.3, 0, -99.99), Vec3(0.3, 0, -99.99), Vec3(0, 0.3, -99.99)});  // upon it
  add({Vec3(-0.3, 0, -90), Vec3(0.3, 0, -90), Vec3(0, 0.3, -90)});           // before it
  const std::vector<Vec3> viewpoints{Vec3(0.0), Vec3(20, 0, 0), Vec3(-20, 0, 0)};
  const SpriteMesh result = contracted(mesh, points, viewpoints, 0.0017);
  ASSERT_EQ(result.triangles.size(), 2U);
  EXPECT_EQ(contracted(mesh, points, viewpoints, 1e-6).triangles.size(), 3U);
}

TEST(TriangleTree, AgreesWithAskingEveryTriangle) {
  Rng rng(11);
  std::vector<Triangle> triangles = test::random_triangles(rng, {Vec3(-4, -3, -2), Vec3(4, 3, 2)}, 60);
  const TriangleTree tree(triangles);
  for (int i = 0; i < 400; ++i) {
    const Vec3 point = test::random_point(rng, {Vec3(-8, -8, -8), Vec3(8, 8, 8)});
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) least = std::min(least, glm::length(point_at(t, nearest_barycentric(t, point)) - point));
    const auto nearest = tree.nearest(point, std::numeric_limits<double>::infinity());
    ASSERT_TRUE(nearest.has_value());
    EXPECT_NEAR(nearest->distance, least, 1e-12);
    EXPECT_FALSE(tree.nearest(point, 0.99 * least).has_value());
  }
}

}  // namespace
}  // namespace standin
