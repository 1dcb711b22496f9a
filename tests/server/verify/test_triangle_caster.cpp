// Rays against triangles: no leaks, the nearest opaque point, and the texel there, each against brute force or by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/base/rng.h"
#include "server/verify/triangle_caster.h"

namespace standin {
namespace {

GlbPage opaque_page(int size) {
  return {size, size, std::vector<std::uint8_t>(4U * static_cast<std::size_t>(size * size), 255)};
}

GlbTriangle triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a, b, c}, {Vec2(0, 0), Vec2(0, 4), Vec2(4, 4)}, 0};
}

Vec3 random_direction(Rng& rng) {
  for (;;) {
    const Vec3 v(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (glm::length(v) > 0.1 && glm::length(v) <= 1.0) return glm::normalize(v);
  }
}

PixelRay ray(const Vec3& origin, const Vec3& direction) {
  return {origin, direction, direction, direction};
}

Vec3 in_float(const Vec3& v) {
  return Vec3(glm::vec3(v));
}

// A ball of `rings` x 2 `rings` facets with a rough surface, 3000 km from the world's origin.
GlbImpostor rough_ball(std::uint64_t seed, int rings) {
  Rng rng(seed);
  std::vector<std::vector<Vec3>> points;
  for (int i = 0; i <= rings; ++i) {
    points.emplace_back();
    for (int j = 0; j < 2 * rings; ++j) {
      const bool pole = i == 0 || i == rings;
      const double theta = std::numbers::pi * i / rings, phi = std::numbers::pi * j / rings;
      const double radius = 3.0 * (pole ? 1.0 : rng.uniform(0.7, 1.0));
      points.back().push_back(in_float(radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi))));
    }
    if (i == 0 || i == rings) std::fill(points.back().begin(), points.back().end(), points.back().front());
  }
  GlbImpostor ball{"imp_0", Vec3(3e6, -2e6, 1e6), {}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(rings); ++i)
    for (std::size_t j = 0; j < points[i].size(); ++j) {
      const std::size_t next = (j + 1) % points[i].size();
      ball.triangles.push_back(triangle(points[i][j], points[i + 1][j], points[i + 1][next]));
      ball.triangles.push_back(triangle(points[i][j], points[i + 1][next], points[i][next]));
    }
  return ball;
}

TEST(TriangleCaster, NoRayLeavesAClosedBall) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(4));
  std::uint64_t rays = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const GlbImpostor ball = rough_ball(seed, 24);
    const TriangleCaster caster(quads, ball, false);
    Rng rng(seed, 1);
    const auto expect_hit = [&](const Vec3& origin, const Vec3& target) {
      ++rays;
      EXPECT_TRUE(caster.first_opaque(ray(ball.origin + origin, glm::normalize(target - origin)), AlphaSampling::kNearest))
          << "seed " << seed << " ray " << rays;
    };
    for (int i = 0; i < 20'000; ++i) expect_hit(0.5 * random_direction(rng), 10.0 * random_direction(rng));
    // At corners, and along edges, where leaks are.
    for (const auto& t : ball.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 along = t.offsets[k] + rng.uniform() * (t.offsets[(k + 1) % 3] - t.offsets[k]);
        for (const Vec3& target : {t.offsets[k], along})
          if (glm::length(target) > 1e-3) expect_hit(Vec3(0.0), target), expect_hit(0.1 * random_direction(rng), target);
      }
  }
  std::printf("%llu rays\n", static_cast<unsigned long long>(rays));
}

// A layer cut into rectangles that meet in T-junctions, all corners rounded to float each on its own.
void cut(Rng& rng, const Box& rectangle, int depth, const Mat3& axes, double distance_m, GlbImpostor& impostor) {
  if (depth > 0) {
    const int axis = static_cast<int>(rng.below(2));
    Box low = rectangle, high = rectangle;
    low.max[axis] = high.min[axis] = rectangle.min[axis] + rng.uniform(0.2, 0.8) * rectangle.size()[axis];
    cut(rng, low, depth - 1, axes, distance_m, impostor);
    cut(rng, high, depth - 1, axes, distance_m, impostor);
    return;
  }
  const auto corner = [&](double x, double y) { return in_float(distance_m * (axes * Vec3(x, y, -1.0))); };
  const Vec3 a = corner(rectangle.min.x, rectangle.max.y), b = corner(rectangle.min.x, rectangle.min.y),
             c = corner(rectangle.max.x, rectangle.min.y), d = corner(rectangle.max.x, rectangle.max.y);
  impostor.triangles.push_back(triangle(a, b, c));
  impostor.triangles.push_back(triangle(a, c, d));
}

TEST(TriangleCaster, RoundedQuadsLeaveNoSlits) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(4));
  Rng rng(5);
  const Mat3 axes = world_from_eye_rotation(glm::normalize(Vec3(1, 0.3, -2)));
  GlbImpostor layer{"imp_0", Vec3(0.0), {}};
  cut(rng, Box{Vec3(-0.5, -0.5, 0.0), Vec3(0.5, 0.5, 0.0)}, 7, axes, 37.0, layer);
  const TriangleCaster caster(quads, layer, false);
  int missed = 0;
  for (const auto& t : layer.triangles)
    for (int i = 0; i < 2000; ++i) {  // along the edges, where slits would be
      const std::size_t k = rng.below(3);
      const Vec3 target = t.offsets[k] + rng.uniform() * (t.offsets[(k + 1) % 3] - t.offsets[k]);
      const Vec3 eye = target * axes / (37.0);
      if (std::max(std::abs(eye.x), std::abs(eye.y)) > 0.4999) continue;
      missed += caster.first_opaque(ray(Vec3(0.0), glm::normalize(target)), AlphaSampling::kNearest) ? 0 : 1;
    }
  EXPECT_EQ(missed, 0);
}

struct Expected {
  std::optional<double> nearest_m;
  bool at_an_edge = false;  // within the caster's tolerance: either answer is right
};

// Möller and Trumbore over all triangles, opaque texels by a checkerboard.
Expected brute_force(const std::vector<GlbTriangle>& triangles, const Vec3& origin, const Vec3& direction) {
  Expected expected;
  auto& nearest = expected.nearest_m;
  for (const auto& t : triangles) {
    const Vec3 e1 = t.offsets[1] - t.offsets[0], e2 = t.offsets[2] - t.offsets[0], s = origin - t.offsets[0];
    const Vec3 p = glm::cross(direction, e2), q = glm::cross(s, e1);
    const double u = glm::dot(p, s) / glm::dot(p, e1), v = glm::dot(q, direction) / glm::dot(p, e1);
    const double distance = glm::dot(q, e2) / glm::dot(p, e1);
    const Vec2 texel = glm::floor((1.0 - u - v) * t.texels[0] + u * t.texels[1] + v * t.texels[2]);
    const bool opaque = static_cast<int>(texel.x + texel.y) % 2 == 0;
    const double inside = std::min({u, v, 1.0 - u - v});
    expected.at_an_edge |= std::abs(inside) < 2.0 * TriangleCaster::kEdgeTolerance;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && opaque && (!nearest || distance < *nearest)) nearest = distance;
  }
  return expected;
}

TEST(TriangleCaster, FindsTheNearestOpaquePointAsBruteForceDoes) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(32));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) quads.pages[0].rgba[static_cast<std::size_t>(4 * (32 * y + x) + 3)] = (x + y) % 2 == 0 ? 255 : 0;
  Rng rng(9);
  GlbImpostor soup{"imp_0", Vec3(100, 0, -50), {}};
  const auto point = [&] { return Vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)); };
  for (int i = 0; i < 150; ++i) {
    const Vec3 centre = 4.0 * point();
    GlbTriangle t = triangle(centre + point(), centre + point(), centre + point());
    for (Vec2& texel : t.texels) texel = Vec2(0.5 + static_cast<double>(rng.below(31)), 0.5 + static_cast<double>(rng.below(31)));
    soup.triangles.push_back(t);
  }
  const TriangleCaster caster(quads, soup, false);
  int hits = 0, passed_holes = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 origin = 10.0 * random_direction(rng);
    const Vec3 direction = glm::normalize(4.0 * point() - origin);
    const auto [expected, at_an_edge] = brute_force(soup.triangles, origin, direction);
    if (at_an_edge) continue;
    const auto found = caster.first_opaque(ray(soup.origin + origin, direction), AlphaSampling::kNearest);
    ASSERT_EQ(found.has_value(), expected.has_value()) << i;
    if (!found) continue;
    EXPECT_NEAR(found->distance_m, *expected, 1e-9) << i;
    EXPECT_NEAR(glm::length(found->point - (soup.origin + origin + *expected * direction)), 0.0, 1e-9);
    ++hits;
    passed_holes += found->distance_m > 10.0 ? 1 : 0;
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(passed_holes, 500);
}

// A floor that recedes from 10 to 30 m, its texture 4 texels long: affine on the floor (5 m a texel), not on the image.
TEST(TriangleCaster, TexelsAreAffineInTheWorld) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(4));
  for (std::size_t i = 0; i < 16; ++i) quads.pages[0].rgba[4 * i + 3] = i / 4 == 3 ? 255 : 0;  // row 3: the nearest 5 m
  GlbImpostor floor{"imp_0", Vec3(0.0), {}};
  const Vec3 a(-5, -2, -30), b(-5, -2, -10), c(5, -2, -10), d(5, -2, -30);
  floor.triangles = {{{a, b, c}, {Vec2(0, 0), Vec2(0, 4), Vec2(4, 4)}, 0}, {{a, c, d}, {Vec2(0, 0), Vec2(4, 4), Vec2(4, 0)}, 0}};
  const TriangleCaster caster(quads, floor, false);
  const auto is_shown = [&](double z) {
    return caster.first_opaque(ray(Vec3(0.0), glm::normalize(Vec3(0.3, -2, z))), AlphaSampling::kNearest).has_value();
  };
  EXPECT_TRUE(is_shown(-10.01));
  EXPECT_TRUE(is_shown(-14.99));
  EXPECT_FALSE(is_shown(-15.01));
  EXPECT_FALSE(is_shown(-29.99));
  EXPECT_FALSE(is_shown(-9.99));
  const auto [along_row, down_column] = caster.texel_steps(1);
  EXPECT_NEAR(glm::length(along_row - Vec3(2.5, 0, 0)), 0.0, 1e-12);
  EXPECT_NEAR(glm::length(down_column - Vec3(0, 0, 5)), 0.0, 1e-12);
}

// Alternate rows, seen so that a pixel is half a texel high near by and two texels far away: filtered to grey there, and so opaque.
TEST(TriangleCaster, MipmapsLookAtTheFootprint) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(8));
  for (std::size_t i = 0; i < 64; ++i) quads.pages[0].rgba[4 * i + 3] = (i / 8) % 2 == 0 ? 255 : 0;
  GlbImpostor pane{"imp_0", Vec3(0.0), {}};
  const Vec3 a(-4, 4, -10), b(-4, -4, -10), c(4, -4, -10), d(4, 4, -10);
  pane.triangles = {{{a, b, c}, {Vec2(0, 0), Vec2(0, 8), Vec2(8, 8)}, 0}, {{a, c, d}, {Vec2(0, 0), Vec2(8, 8), Vec2(8, 0)}, 0}};
  const TriangleCaster caster(quads, pane, true);
  const auto through = [](double x, double y, double step_m) {
    const auto direction = [&](double dx, double dy) { return glm::normalize(Vec3(x + dx, y - dy, -10.0)); };
    return PixelRay{Vec3(0.0), direction(0, 0), direction(step_m, 0), direction(0, step_m)};
  };
  // At y = 0.5 the middle of row 3, which is transparent.
  for (const double step_m : {0.5, 2.0}) EXPECT_FALSE(caster.first_opaque(through(0.2, 0.5, step_m), AlphaSampling::kBilinear)) << step_m;
  EXPECT_FALSE(caster.first_opaque(through(0.2, 0.5, 0.5), AlphaSampling::kMipmapped));
  EXPECT_TRUE(caster.first_opaque(through(0.2, 0.5, 2.0), AlphaSampling::kMipmapped));
}

TEST(TriangleCaster, TrianglesWithoutAreaShowNothing) {
  GlbQuads quads;
  quads.pages.push_back(opaque_page(4));
  const GlbImpostor line{"imp_0", Vec3(0.0), {triangle(Vec3(-1, 0, -5), Vec3(0, 0, -5), Vec3(1, 0, -5))}};
  EXPECT_FALSE(TriangleCaster(quads, line, false).first_opaque(ray(Vec3(0.0), Vec3(0, 0, -1)), AlphaSampling::kNearest));
}

}  // namespace
}  // namespace standin
