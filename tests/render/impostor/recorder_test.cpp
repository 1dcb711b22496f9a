// Recording by hand-made scenes whose texels can be counted on paper, and closed coverage against an exact separating-axis test.
#include "render/impostor/recorder.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "render/impostor/coverage.h"
#include "render/scene/shading.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

using test::rectangle;
using test::rectangle_uvs;
using test::SmallScene;
using Texels = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// 8 x 8 texels of slope 0.25 about the -z axis, seen from the origin: at depth 4 a texel is 1 m wide and the texture spans [-4, 4].
ImpostorFrame frame_of_eight() {
  ImpostorFrame frame;
  frame.slope_min = {-1.0, 1.0};
  frame.slope_step = Vec2(0.25);
  frame.width = frame.height = 8;
  return frame;
}

const std::vector<Layer> kOneLayer{{4.0, 1.0, 100.0}};

std::vector<LayerImage> record(const Scene& scene, const ImpostorFrame& frame, const std::vector<Layer>& layers,
                               Coverage coverage = Coverage::kClosed) {
  std::vector<std::uint32_t> objects(scene.objects.size());
  for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = i;
  return record_layers(scene, TexturePyramids(scene), objects, frame, layers, coverage);
}

Texels texels_of(const LayerImage& image) {
  Texels texels;
  image.for_each_opaque([&](std::uint32_t x, std::uint32_t y) { texels.insert({x, y}); });
  return texels;
}

Texels block(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
  Texels texels;
  for (std::uint32_t y = y0; y <= y1; ++y)
    for (std::uint32_t x = x0; x <= x1; ++x) texels.insert({x, y});
  return texels;
}

Texels recorded_wall(const Vec3& corner, double width, double height, Coverage coverage = Coverage::kClosed) {
  SmallScene scene;
  scene.add_object(rectangle(corner, {width, 0, 0}, {0, height, 0}));
  return texels_of(record(scene.scene, frame_of_eight(), kOneLayer, coverage)[0]);
}

TEST(Recorder, AWallCoversTheTexelsItTouches) {
  EXPECT_EQ(recorded_wall({-1.9, -0.9, -4}, 2.8, 2.8), block(2, 2, 4, 4));
  // Exactly on texel borders: the neighbours' closed squares touch it.
  EXPECT_EQ(recorded_wall({-2, -1, -4}, 3, 3), block(1, 1, 5, 5));
  EXPECT_EQ(recorded_wall({-2, -1, -4}, 3, 3, Coverage::kCentre), block(2, 2, 4, 4));
}

TEST(Recorder, NothingThinIsMissed) {
  EXPECT_EQ(recorded_wall({-3.5, 0.2, -4}, 1e-4, 2.6), block(0, 1, 0, 3));            // far from any texel centre
  EXPECT_EQ(recorded_wall({-3.6, 0.2, -4}, 1e-4, 2.6, Coverage::kCentre), Texels{});  // which is why centres do not do
  EXPECT_EQ(recorded_wall({0.3, 0.3, -4}, 1e-3, 1e-3), block(4, 3, 4, 3));            // a speck
  SmallScene edge_on;
  edge_on.add_object(rectangle({-2, 0, -4}, {5, 0, 0}, {0, 0, -3}));  // the plane y = 0 holds the viewpoint
  EXPECT_EQ(texels_of(record(edge_on.scene, frame_of_eight(), kOneLayer)[0]), block(1, 3, 7, 4));
}

TEST(Recorder, WhatLiesOutsideTheTextureIsCutOff) {
  EXPECT_EQ(recorded_wall({-50, -50, -4}, 100, 100), block(0, 0, 7, 7));
  EXPECT_EQ(recorded_wall({5, 5, -4}, 10, 10), Texels{});
}

TEST(Recorder, BothSidesAreRecorded) {
  Material single_sided = SmallScene::white();
  single_sided.double_sided = false;
  SmallScene scene;
  scene.add_object({{Vec3(-1, -1, -4), Vec3(-1, 1, -4), Vec3(1, 1, -4)}}, single_sided);
  EXPECT_FALSE(texels_of(record(scene.scene, frame_of_eight(), kOneLayer)[0]).empty());
}

// A staircase of three walls in three layers, and a slope through all of them.
TEST(Recorder, EachLayerHoldsItsOwnDepths) {
  const std::vector<Layer> layers{{4, 3, 5}, {6, 5, 7}, {8, 7, 9}};
  SmallScene stairs;
  for (int step = 0; step < 3; ++step) stairs.add_object(rectangle({0.1, 0.1, -4.0 - 2 * step}, {0.1, 0, 0}, {0, 0.1, 0}));
  for (const LayerImage& image : record(stairs.scene, frame_of_eight(), layers)) EXPECT_EQ(texels_of(image), block(4, 3, 4, 3));

  SmallScene slope;  // from slope -0.9 at depth 3 to +0.9 at depth 9
  slope.add_object({{Vec3(-2.7, -0.3, -3), Vec3(-2.7, 0.3, -3), Vec3(8.1, 0, -9)}});
  const auto images = record(slope.scene, frame_of_eight(), layers);
  const double at_5 = (-2.7 + 10.8 / 3.0) / 5.0, at_7 = (-2.7 + 10.8 * 2.0 / 3.0) / 7.0;  // slopes of the clip lines
  const auto column = [](double s) { return static_cast<std::uint32_t>((s + 1.0) / 0.25); };
  for (const auto& [near, far, s] : {std::tuple{0, 1, at_5}, std::tuple{1, 2, at_7}}) {
    bool shared = false;
    for (std::uint32_t y = 0; y < 8; ++y) {
      const bool in_near = images[static_cast<std::size_t>(near)].get(column(s), y).opaque();
      EXPECT_EQ(in_near, images[static_cast<std::size_t>(far)].get(column(s), y).opaque()) << "row " << y;
      shared = shared || in_near;
    }
    EXPECT_TRUE(shared);
  }
  EXPECT_FALSE(images[0].get(column(0.85), 3).opaque());
  EXPECT_FALSE(images[2].get(column(-0.85), 3).opaque());
}

Material coloured(float red, float green, float blue) {
  Material material = SmallScene::white();
  material.base_colour = {red, green, blue, 1.0F};
  return material;
}

TEST(Recorder, TheNearerSurfaceWinsAndCentresBeatRims) {
  SmallScene scene;
  scene.add_object(rectangle({-4, -4, -5}, {8, 0, 0}, {0, 8, 0}), coloured(0, 1, 0));
  scene.add_object(rectangle({-0.9, -0.9, -4}, {1.8, 0, 0}, {0, 1.8, 0}), coloured(1, 0, 0));  // texels 3..4, all but their rims
  scene.add_object(rectangle({2.1, 2.1, -4}, {0.2, 0, 0}, {0, 0.2, 0}), coloured(0, 0, 1));    // in texel (6,1), beside its centre
  for (const auto& order : {std::vector<std::uint32_t>{0, 1, 2}, std::vector<std::uint32_t>{2, 1, 0}}) {
    const auto image =
        std::move(record_layers(scene.scene, TexturePyramids(scene.scene), order, frame_of_eight(), kOneLayer, Coverage::kClosed)[0]);
    EXPECT_EQ(image.get(3, 3).rgba, (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
    EXPECT_EQ(image.get(6, 1).rgba, (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
    EXPECT_EQ(image.get(1, 1).rgba, (std::array<std::uint8_t, 4>{0, 255, 0, 255}));
  }
}

TEST(Recorder, ColoursFollowTheShadingRule) {
  SmallScene scene;
  Material lit;
  lit.base_colour = {0.5F, 0.25F, 1.0F, 1.0F};
  scene.add_object(rectangle({-4, -4, -4}, {8, 0, 0}, {0, 8, 0}), lit);
  const auto rgba = record(scene.scene, frame_of_eight(), kOneLayer)[0].get(2, 5).rgba;
  const double brightness = kAmbient + kDiffuse * std::abs(light_direction().z);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgba[static_cast<std::size_t>(c)], 255.0 * lit.base_colour[c] * brightness, 0.6);
}

Texture texture_of(int side, const std::function<std::array<std::uint8_t, 4>(int, int)>& texel) {
  Texture texture{"t", side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto rgba = texel(x, y);
      texture.rgba.insert(texture.rgba.end(), rgba.begin(), rgba.end());
    }
  return texture;
}

/// A wall over the whole texture; its texture's row 0 is at the top.
std::vector<LayerImage> record_textured_wall(const Texture& texture, bool masked, double depth = 4.0) {
  SmallScene scene;
  Material material = SmallScene::white();
  material.texture = 0;
  if (masked) material.alpha_mode = AlphaMode::kMask;
  scene.scene.textures.push_back(texture);
  scene.add_object(rectangle(depth * Vec3(-1, 1, -1), {2 * depth, 0, 0}, {0, -2 * depth, 0}), material, rectangle_uvs());
  return record(scene.scene, frame_of_eight(), kOneLayer);
}

TEST(Recorder, TexturesAreFilteredAsADeviceWould) {
  const auto one_to_one = record_textured_wall(
      texture_of(8,
                 [](int x, int y) {
                   return std::array<std::uint8_t, 4>{static_cast<std::uint8_t>(30 * x), static_cast<std::uint8_t>(20 * y), 7, 255};
                 }),
      false);
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 8; ++x) {
      EXPECT_EQ(one_to_one[0].get(x, y).rgba[0], 30 * x);
      EXPECT_EQ(one_to_one[0].get(x, y).rgba[1], 20 * y);
    }
  const auto minified = record_textured_wall(
      texture_of(64,
                 [](int x, int y) {
                   return (x + y) % 2 == 0 ? std::array<std::uint8_t, 4>{200, 0, 0, 255} : std::array<std::uint8_t, 4>{0, 100, 0, 255};
                 }),
      false);
  EXPECT_NEAR(minified[0].get(3, 4).rgba[0], 100, 1);
  EXPECT_NEAR(minified[0].get(3, 4).rgba[1], 50, 1);
}

// One opaque texel among 64 x 64 must survive in every impostor texel that it meets, in its own colour, and nowhere else.
TEST(Recorder, MasksAreKeptWhereAnyPartOfATexelIsOpaque) {
  const auto dot = [](int at_x, int at_y) {
    return texture_of(64, [=](int x, int y) {
      return x == at_x && y == at_y ? std::array<std::uint8_t, 4>{250, 120, 10, 255} : std::array<std::uint8_t, 4>{0, 0, 0, 0};
    });
  };
  const auto inside = record_textured_wall(dot(27, 43), true);  // 64 / 8: texel (3, 5), not on a border
  EXPECT_EQ(texels_of(inside[0]), block(3, 5, 3, 5));
  EXPECT_EQ(inside[0].get(3, 5).rgba, (std::array<std::uint8_t, 4>{250, 120, 10, 255}));
  const Texels on_border = texels_of(record_textured_wall(dot(24, 43), true)[0]);  // its left side is the border between texels 2 and 3
  EXPECT_TRUE(on_border.count({3, 5}) == 1);
  for (const auto& [x, y] : on_border) EXPECT_TRUE((x == 2 || x == 3) && y == 5);
}

TEST(Recorder, MaskedColoursDoNotMixWithWhatIsCutAway) {
  const auto image = record_textured_wall(
      texture_of(64,
                 [](int x, int y) {
                   return (x + y) % 2 == 0 ? std::array<std::uint8_t, 4>{240, 10, 20, 255} : std::array<std::uint8_t, 4>{0, 255, 0, 100};
                 }),
      true);
  EXPECT_EQ(texels_of(image[0]), block(0, 0, 7, 7));
  EXPECT_EQ(image[0].get(4, 4).rgba, (std::array<std::uint8_t, 4>{240, 10, 20, 255}));
  const auto nothing = record_textured_wall(texture_of(64, [](int, int) { return std::array<std::uint8_t, 4>{9, 9, 9, 127}; }), true);
  EXPECT_TRUE(nothing[0].empty());
}

TEST(Recorder, StopsOnRequest) {
  const std::atomic<bool> stop{true};
  SmallScene scene;
  scene.add_object(rectangle({-1, -1, -4}, {2, 0, 0}, {0, 2, 0}));
  const std::vector<std::uint32_t> objects{0};
  EXPECT_THROW((void)record_layers(scene.scene, TexturePyramids(scene.scene), objects, frame_of_eight(), kOneLayer, Coverage::kClosed,
                                   WorkBudget(&stop)),
               Failure);
}

/// Least distance by which axis-parallel and edge directions separate a convex polygon from a square; <= 0: they meet.
double separation(const Piece& piece, double x, double y) {
  double gap = -1e300;
  const auto try_axis = [&](const Vec2& axis) {
    const double length = glm::length(axis);
    if (length == 0.0) return;
    double low = 1e300, high = -1e300, square_low = 1e300, square_high = -1e300;
    for (std::size_t i = 0; i < piece.count; ++i) {
      const double d = glm::dot(piece.vertices[i].position, axis) / length;
      low = std::min(low, d);
      high = std::max(high, d);
    }
    for (const Vec2& corner : {Vec2(x, y), Vec2(x + 1, y), Vec2(x, y + 1), Vec2(x + 1, y + 1)}) {
      const double d = glm::dot(corner, axis) / length;
      square_low = std::min(square_low, d);
      square_high = std::max(square_high, d);
    }
    gap = std::max({gap, low - square_high, square_low - high});
  };
  try_axis({1, 0});
  try_axis({0, 1});
  for (std::size_t i = 0; i < piece.count; ++i) {
    const Vec2 edge = piece.vertices[(i + 1) % piece.count].position - piece.vertices[i].position;
    try_axis({-edge.y, edge.x});
  }
  return gap;
}

TEST(ClosedCoverage, IsWhatASeparatingAxisTestFinds) {
  Rng rng(7);
  ClosedCoverage coverage(20, 15);
  int drawn = 0;
  for (int i = 0; i < 3000; ++i) {
    Piece piece;
    const double size = std::pow(10.0, rng.uniform(-3.0, 1.5));
    const Vec2 centre(rng.uniform(-3.0, 23.0), rng.uniform(-3.0, 18.0));
    for (int k = 0; k < 3; ++k) {
      PieceVertex vertex;
      vertex.position = centre + size * Vec2(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0) * (i % 3 == 0 ? 1e-7 : 1.0));
      if (i % 5 == 0) vertex.position = glm::round(vertex.position);  // exact touches
      piece.add(vertex);
    }
    Texels texels;
    coverage.for_each_row(piece, [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t x = first; x <= last; ++x) texels.insert({x, y});
    });
    for (std::uint32_t y = 0; y < 15; ++y)
      for (std::uint32_t x = 0; x < 20; ++x) {
        const double gap = separation(piece, x, y);
        if (gap <= 0.0) {
          EXPECT_EQ(texels.count({x, y}), 1U) << "piece " << i << " texel " << x << " " << y << " gap " << gap;
        } else if (gap > 1e-8) {
          EXPECT_EQ(texels.count({x, y}), 0U) << "piece " << i << " texel " << x << " " << y << " gap " << gap;
        }
      }
    drawn += static_cast<int>(texels.size());
  }
  EXPECT_GT(drawn, 1000);
}

}  // namespace
}  // namespace standin
