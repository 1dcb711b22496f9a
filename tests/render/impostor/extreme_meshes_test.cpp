// Meshes at the ends of what files hold: thinner than a texel, edge-on, non-manifold, double-sided, duplicate, without area, all cut out by
// their mask, or a thousand kilometres from the origin. Each leaves the impostor that its visible points ask for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

ViewCell cell_towards_z(double distance = 20.0) {
  return Box{Vec3(-2.0, -1.0, distance), Vec3(2.0, 1.0, distance + 4.0)};
}

Impostor bake(const std::vector<WorldTriangle>& triangles, const ViewCell& cell, const BakeQuality& quality = {}) {
  SmallScene scene;
  scene.add_object(triangles);
  return bake_layered(scene.scene, {{0}, cell}, {}, quality);
}

std::vector<WorldTriangle> some_triangles(int count = 30) {
  Rng rng(23);
  return test::random_triangles(rng, {Vec3(-3.0), Vec3(3.0)}, count);
}

void expect_same(const Impostor& a, const Impostor& b) {
  ASSERT_EQ(a.layers.size(), b.layers.size());
  ASSERT_EQ(a.quads.size(), b.quads.size());
  EXPECT_EQ(a.frame.width, b.frame.width);
  EXPECT_EQ(a.frame.height, b.frame.height);
  EXPECT_EQ(a.texels, b.texels);
}

void append(std::vector<WorldTriangle>& to, const std::vector<WorldTriangle>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

TEST(ExtremeMeshes, DuplicateFacesChangeNothing) {
  const auto once = some_triangles();
  auto twice = once;
  append(twice, once);
  expect_same(bake(once, cell_towards_z()), bake(twice, cell_towards_z()));
}

TEST(ExtremeMeshes, FacesOfNoAreaChangeNothing) {
  const auto plain = some_triangles();
  auto more = plain;
  const Vec3 a = plain[0][0], b = plain[0][1];
  append(more, {{a, a, a}, {a, b, b}, {a, b, a}, {a, 0.5 * (a + b), b}});
  const Impostor with = bake(more, cell_towards_z()), without = bake(plain, cell_towards_z());
  // The last one's middle is rounded to float: a sliver that a ray may hit, along an edge that is drawn already.
  EXPECT_EQ(with.layers.size(), without.layers.size());
  EXPECT_EQ(with.texels, without.texels);
}

// Which way a face turns, and whether it is there both ways, is not seen: the recorder is two-sided.
TEST(ExtremeMeshes, BothSidesOfAFaceAreOneImage) {
  const auto front = some_triangles();
  auto back = front;
  for (WorldTriangle& triangle : back) std::swap(triangle[1], triangle[2]);
  auto both = front;
  append(both, back);
  const Impostor one = bake(front, cell_towards_z());
  expect_same(one, bake(both, cell_towards_z()));
  expect_same(one, bake(back, cell_towards_z()));
}

// Three fins on one edge, and two fans that share a single vertex.
TEST(ExtremeMeshes, NonManifoldEdgesAndVerticesKeepThePromise) {
  std::vector<WorldTriangle> triangles;
  for (const Vec3& fin : {Vec3(2, 0, 0), Vec3(-1, 0, 2), Vec3(-1, 0, -2)}) append(triangles, rectangle({0, -2, 0}, {0, 4, 0}, fin));
  for (int i = 0; i < 6; ++i) {
    const double from = i, to = i + 1.0, height = i % 2 == 0 ? 2.5 : -2.5;
    triangles.push_back({Vec3(0.0), Vec3(std::cos(from), height, std::sin(from)), Vec3(std::cos(to), height, std::sin(to))});
  }
  for (WorldTriangle& triangle : triangles)
    for (Vec3& corner : triangle) corner = Vec3(glm::vec3(corner));
  const Impostor impostor = bake(triangles, cell_towards_z());
  const Verdict verdict = test::judge(test::opaque_surfaces(triangles), impostor, Camera{}.pixel_angle_rad(), 400, 3);
  EXPECT_GT(verdict.judged, 200);
  EXPECT_EQ(verdict.gaps, 0);
  EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
}

/// Texel columns in which any layer shows something.
std::uint32_t filled_columns(const Impostor& impostor) {
  const test::DrawnImpostor drawn(impostor);
  std::uint32_t filled = 0;
  for (std::uint32_t x = 0; x < impostor.frame.width; ++x) {
    bool any = false;
    for (std::size_t layer = 0; layer < impostor.layers.size(); ++layer)
      for (std::uint32_t y = 0; y < impostor.frame.height; ++y) any = any || drawn.texel(layer, x, y)[3] != 0;
    filled += any ? 1 : 0;
  }
  return filled;
}

TEST(ExtremeMeshes, ThinnerThanATexelIsALineWithoutGaps) {
  for (const double thickness : {1e-3, 1e-6, 1e-12, 1e-30}) {
    SCOPED_TRACE("thickness " + std::to_string(thickness));
    const Impostor wire = bake(rectangle({-3, 0, -1}, {6, 0, 2}, {0, thickness, 0}), cell_towards_z(), {.seal_rims = false});
    EXPECT_GT(wire.frame.width, 100U);
    EXPECT_EQ(wire.frame.height, 1U);
    EXPECT_EQ(filled_columns(wire), wire.frame.width);
  }
}

// A plane through the reference viewpoint itself: no ray from there hits it, yet others of the cell see it.
TEST(ExtremeMeshes, PlanesSeenEdgeOnAreRecorded) {
  for (const bool masked : {false, true}) {
    SmallScene scene;
    Material material = SmallScene::white();
    scene.scene.textures.push_back({"opaque", 2, 2, std::vector<std::uint8_t>(16, 255)});
    if (masked) material.alpha_mode = AlphaMode::kMask;
    material.texture = masked ? 0 : -1;
    scene.add_object(rectangle({0, -3, -3}, {0, 6, 0}, {0, 0, 6}), material, test::rectangle_uvs());
    const Impostor impostor = bake_layered(scene.scene, {{0}, cell_towards_z()}, {}, {.seal_rims = false});
    EXPECT_EQ(impostor.frame.width, 1U);
    EXPECT_GT(impostor.layers.size(), 3U);
    const test::DrawnImpostor drawn(impostor);
    for (std::uint32_t y = 0; y < impostor.frame.height; ++y) {
      bool any = false;
      for (std::size_t layer = 0; layer < impostor.layers.size(); ++layer) any = any || drawn.texel(layer, 0, y)[3] != 0;
      EXPECT_TRUE(any) << "row " << y;
    }
    std::vector<test::Surface> surfaces = test::opaque_surfaces(rectangle({0, -3, -3}, {0, 6, 0}, {0, 0, 6}));
    const Verdict verdict = test::judge(surfaces, impostor, Camera{}.pixel_angle_rad(), 400, 9);
    EXPECT_GT(verdict.judged, 100);
    EXPECT_EQ(verdict.gaps, 0);
  }
}

TEST(ExtremeMeshes, WhollyCutOutObjectsLeaveNothing) {
  for (const bool textured : {true, false}) {
    SmallScene scene;
    Material material = SmallScene::white();
    material.alpha_mode = AlphaMode::kMask;
    scene.scene.textures.push_back({"clear", 2, 2, std::vector<std::uint8_t>(16, 20)});
    if (textured)
      material.texture = 0;
    else
      material.base_colour.a = 0.1F;
    scene.add_object(some_triangles(), material, std::vector<std::array<Vec2, 3>>(30, {Vec2(0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)}));
    Impostor impostor = bake_layered(scene.scene, {{0}, cell_towards_z()}, {}, {});
    EXPECT_TRUE(impostor.empty());
    EXPECT_EQ(texture_bytes(impostor), 0U);
    std::vector<Impostor> impostors;
    impostors.push_back(std::move(impostor));
    const ImpostorSet set = pack_atlas(std::move(impostors));
    EXPECT_TRUE(set.pages.empty());
    EXPECT_FALSE(encode_impostor_glb(set).empty());
  }
}

// Positions that doubles hold exactly: then the same impostor comes out, bit for bit, wherever the scene lies.
TEST(ExtremeMeshes, AThousandKilometresFromTheOriginIsLikeAtTheOrigin) {
  auto triangles = some_triangles();
  for (WorldTriangle& triangle : triangles)
    for (Vec3& corner : triangle) corner = glm::round(corner * 256.0) / 256.0;
  const Vec3 away(1048576.0, -1048576.0, 524288.0);
  SmallScene here, there;
  here.add_object(triangles);
  there.add_object(triangles);
  there.scene.objects[0].world_from_object[3] = Vec4(away, 1.0);
  there.scene.objects[0].bounds.min += away;
  there.scene.objects[0].bounds.max += away;
  const Box cell = std::get<Box>(cell_towards_z());
  const Impostor near = bake_layered(here.scene, {{0}, cell}, {}, {});
  const Impostor far = bake_layered(there.scene, {{0}, Box{cell.min + away, cell.max + away}}, {}, {});
  EXPECT_EQ(far.frame.reference_viewpoint, near.frame.reference_viewpoint + away);
  expect_same(near, far);
}

// Positions in single precision at that distance are 6 cm apart: what they say is what is recorded.
TEST(ExtremeMeshes, SinglePrecisionFarFromTheOriginKeepsThePromise) {
  const Vec3 away(1e6, 2e5, -1e6);
  auto triangles = some_triangles();
  for (WorldTriangle& triangle : triangles)
    for (Vec3& corner : triangle) corner = Vec3(glm::vec3(corner + away));
  const Box cell = std::get<Box>(cell_towards_z());
  const Impostor impostor = bake(triangles, Box{cell.min + away, cell.max + away});
  const Verdict verdict = test::judge(test::opaque_surfaces(triangles), impostor, Camera{}.pixel_angle_rad(), 400, 4);
  EXPECT_GT(verdict.judged, 150);
  EXPECT_EQ(verdict.gaps, 0);
  EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-5);
}

}  // namespace
}  // namespace standin
