// Planar impostors: when one plane is enough, and how a view cell is cut where it is not.
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/impostor/bake_planar.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

Shaft shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

/// Two walls that face +z, `depth` apart.
Scene walls(double depth) {
  test::SmallScene scene;
  scene.add_object(test::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  scene.add_object(test::rectangle({-1, -1, -depth}, {2, 0, 0}, {0, 2, 0}));
  return std::move(scene.scene);
}

BakeRequest request_of(const ViewCell& cell) {
  return {{0, 1}, cell};
}

Vec3 random_in(Rng& rng, const Shaft& shaft) {
  const double along = shaft.min_distance_m * (1.0 + 5.0 * rng.uniform() * rng.uniform());
  const Vec2 slope = Vec2(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)) * shaft.tan_half;
  return shaft.apex + along * (shaft.axis + slope.x * shaft.right + slope.y * shaft.up);
}

bool one_layer(const Scene& scene, const BakeRequest& part) {
  try {
    return bake_planar(scene, TexturePyramids(scene), part, Camera{}, {}).layers.size() == 1;
  } catch (const Failure&) {
    return false;
  }
}

TEST(Planar, OneLayerIsTheLayeredImpostor) {
  const Scene scene = walls(0.0);
  const TexturePyramids textures(scene);
  const BakeRequest request = request_of(shaft_towards_z(0.2, 30.0));
  const Impostor planar = bake_planar(scene, textures, request, Camera{}, {});
  EXPECT_EQ(planar.technique, Technique::kPlanar);
  EXPECT_EQ(planar.layers.size(), 1U);
  EXPECT_EQ(guarantee_name(planar), "nearest");
  EXPECT_EQ(planar.texels, bake_layered(scene, textures, request, Camera{}, {}).texels);
  EXPECT_EQ(textured_mesh(planar).triangle_count(), 2 * planar.quads.size());
}

TEST(Planar, MoreLayersAreRefusedWithTheirNumber) {
  const Scene scene = walls(6.0);
  const BakeRequest request = request_of(shaft_towards_z(0.2, 30.0));
  const std::size_t layers = bake_layered(scene, request, Camera{}, {}).layers.size();
  ASSERT_GT(layers, 1U);
  try {
    static_cast<void>(bake_planar(scene, TexturePyramids(scene), request, Camera{}, {}));
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kImpostorImpossible);
    EXPECT_NE(std::string(failure.what()).find("needs " + std::to_string(layers) + " layers; a planar impostor has one"), std::string::npos)
        << failure.what();
  }
}

TEST(Planar, AWallNeedsNoCut) {
  const ViewCell cell = shaft_towards_z(0.4, 30.0);
  const auto parts = planar_requests(walls(0.0), request_of(cell), Camera{}, {});
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(std::get<Shaft>(parts[0].view_cell).tan_half, Vec2(0.4));
}

// A box beside two walls, h apart, is as wide as it is high and thin along the view. A plane at distance A from the reference viewpoint P
// half way across the box shows the wall at A' off by about w / 2 |1/A - 1/A'| from the border of a box of width w. With alpha one pixel of
// 1/618 and the plane between the walls (1/A the middle of theirs), that is w / 4 (1/40 - 1/42) < 1/618 for w < 5.4 m. So a box of 10 m
// must be cut across, and not along the view.
TEST(Planar, ABoxIsCutAcrossTheView) {
  const Scene scene = walls(2.0);
  const BakeRequest request = request_of(Box{Vec3(-5.0, -0.1, 40.0), Vec3(5.0, 0.1, 40.1)});
  ASSERT_FALSE(one_layer(scene, request));
  const auto parts = planar_requests(scene, request, Camera{}, {});
  ASSERT_GE(parts.size(), 2U);
  EXPECT_LE(parts.size(), 4U);  // the strict form of the layers' formulas asks for somewhat more than the estimate above
  for (const BakeRequest& part : parts) {
    const Box& box = std::get<Box>(part.view_cell);
    EXPECT_EQ(box.size().y, 0.2);
    EXPECT_NEAR(box.size().x, 10.0 / static_cast<double>(parts.size()), 1e-12);
  }
}

// As in the thesis' example (3.7.2): nine, three across and three up.
TEST(Planar, AShaftIsCutInBothDirectionsOfItsAperture) {
  const Scene scene = walls(1.0);
  const BakeRequest request = request_of(shaft_towards_z(0.24, 60.0));
  EXPECT_EQ(planar_requests(scene, request, Camera{}, {}).size(), 9U);
}

TEST(Planar, PartsNeedOneLayerEachAndCoverTheCell) {
  Rng rng(5);
  const Scene scene = walls(2.0);
  const std::vector<ViewCell> cells{shaft_towards_z(0.2, 60.0), shaft_towards_z(0.5, 120.0), Box{Vec3(-4, -3, 40), Vec3(4, 3, 50)}};
  for (const ViewCell& cell : cells) {
    const auto parts = planar_requests(scene, request_of(cell), Camera{}, {});
    EXPECT_GT(parts.size(), 1U);
    for (const BakeRequest& part : parts) EXPECT_TRUE(one_layer(scene, part));
    for (int i = 0; i < 2000; ++i) {
      const Vec3 viewer =
          std::holds_alternative<Box>(cell) ? test::random_point(rng, std::get<Box>(cell)) : random_in(rng, std::get<Shaft>(cell));
      EXPECT_TRUE(std::any_of(parts.begin(), parts.end(), [&](const BakeRequest& part) { return encloses(part.view_cell, viewer); }));
    }
  }
}

TEST(Planar, FewerPartsOfEqualSizeAreNotEnough) {
  const Scene scene = walls(2.0);
  const BakeRequest request = request_of(Box{Vec3(-8.0, -0.1, 40.0), Vec3(8.0, 0.1, 40.1)});
  const auto parts = planar_requests(scene, request, Camera{}, {});
  ASSERT_GT(parts.size(), 2U);
  const double width = 16.0 / static_cast<double>(parts.size() - 1);
  EXPECT_FALSE(one_layer(scene, request_of(Box{Vec3(-8.0, -0.1, 40.0), Vec3(-8.0 + width, 0.1, 40.1)})));
}

TEST(Planar, TooManyPartsAreRefused) {
  const BakeRequest request = request_of(shaft_towards_z(0.5, 10.0));
  EXPECT_THROW(static_cast<void>(planar_requests(walls(6.0), request, Camera{}, {}, 3)), Failure);
}

}  // namespace
}  // namespace standin
