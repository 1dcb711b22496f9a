// The bound on a surface's deviation holds against dense sampling, is tight where work is allowed, and holds where it is not.

#include "render/scene/surface_deviation.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/scene/mesh_builder.h"

namespace standin {
namespace {

Mesh wavy(int n, double height_m, double phase = 0.0) {
  MeshBuilder builder;
  builder.surface([&](double u, double v) { return Vec3(u, height_m * std::sin(9 * u + phase) * std::cos(7 * v), v); }, n, n);
  return builder.finish("wavy");
}

SurfacePoint random_point(const Surface& surface, Rng& rng) {
  const SurfaceTriangle t = surface.corners(rng.below(surface.triangles.size()));
  const double root = std::sqrt(rng.uniform()), s = rng.uniform();
  const double a = 1.0 - root, b = root * (1.0 - s), c = root * s;
  return {a * t[0].place + b * t[1].place + c * t[2].place, a * t[0].texture + b * t[1].texture + c * t[2].texture};
}

double brute_force_distance(const SurfacePoint& point, const Surface& surface) {
  double least = 1e300;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) least = std::min(least, distance(point, surface.corners(t)));
  return least;
}

double sampled_deviation(const Surface& from, const Surface& to, int samples) {
  Rng rng(5);
  double most = 0.0;
  for (int i = 0; i < samples; ++i) most = std::max(most, brute_force_distance(random_point(from, rng), to));
  return most;
}

TEST(SurfaceDeviation, DistanceToATriangle) {
  const SurfaceTriangle triangle{SurfacePoint{{0, 0, 0}, {}}, SurfacePoint{{1, 0, 0}, {}}, SurfacePoint{{0, 1, 0}, {}}};
  EXPECT_DOUBLE_EQ(distance({{0.2, 0.2, 3.0}, {}}, triangle), 3.0);
  EXPECT_DOUBLE_EQ(distance({{-3.0, 0.5, 4.0}, {}}, triangle), 5.0);
  EXPECT_DOUBLE_EQ(distance({{2.0, -1.0, 0.0}, {}}, triangle), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(distance({{1.0, 1.0, 0.0}, {}}, triangle), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(distance({{0.25, 0.25, 0.0}, {0.0, 2.0}}, triangle), 2.0);  // the picture lies 2 m away
}

TEST(SurfaceDeviation, NearestIsThatOfEveryTriangle) {
  const Surface surface = surface_of(wavy(12, 0.2), 1.0);
  const SurfaceTree tree(surface);
  Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    const SurfacePoint point{{rng.uniform(-1, 2), rng.uniform(-1, 1), rng.uniform(-1, 2)}, {rng.uniform(), rng.uniform()}};
    const auto guess = static_cast<std::uint32_t>(rng.below(surface.triangles.size()));
    EXPECT_DOUBLE_EQ(tree.nearest(point, guess).distance, brute_force_distance(point, surface));
  }
}

// However a plane is divided into triangles, it is the same plane; and it takes few pieces to say so.
TEST(SurfaceDeviation, OfAPlaneDividedOtherwiseIsNothing) {
  MeshBuilder coarse, fine;
  coarse.patch({0, 0, 0}, {30, 0, 0}, {30, 0, 20}, {0, 0, 20}, 3, 2);
  fine.patch({0, 0, 0}, {30, 0, 0}, {30, 0, 20}, {0, 0, 20}, 13, 7);
  const Surface a = surface_of(coarse.finish("coarse"), 1.0), b = surface_of(fine.finish("fine"), 1.0);
  DeviationLimits limits;
  limits.absolute_m = 1e-6;
  limits.pieces = 20'000;
  EXPECT_LE(deviation(a, SurfaceTree(b), limits).bound_m, 1e-6);
  EXPECT_LE(deviation(b, SurfaceTree(a), limits).bound_m, 1e-6);
}

TEST(SurfaceDeviation, OfSurfacesApartIsTheirDistance) {
  const Mesh mesh = wavy(10, 0.0);
  Mesh raised = mesh;
  for (glm::vec3& position : raised.positions) position.y += 0.25F;
  const Deviation found = deviation(surface_of(mesh, 0.0), SurfaceTree(surface_of(raised, 0.0)), {});
  EXPECT_NEAR(found.found_m, 0.25, 1e-6);
  EXPECT_GE(found.bound_m, 0.25 - 1e-6);
  EXPECT_LE(found.bound_m, 1.25 * 0.25 + 1e-6);
}

// A wall that keeps its place but shows another part of its picture has moved.
TEST(SurfaceDeviation, CountsTheTextureSlip) {
  const Mesh mesh = wavy(8, 0.1);
  Mesh slipped = mesh;
  for (glm::vec2& uv : slipped.uvs) uv.x += 0.2F;
  const double scale = 1.2;
  EXPECT_NEAR(deviation(surface_of(mesh, scale), SurfaceTree(surface_of(slipped, scale)), {}).found_m, 0.2 * scale, 0.01);
  EXPECT_NEAR(deviation(surface_of(mesh, 0.0), SurfaceTree(surface_of(slipped, 0.0)), {}).found_m, 0.0, 1e-6);
}

TEST(SurfaceDeviation, BoundHoldsWhateverTheWorkAndTightens) {
  const Surface fine = surface_of(wavy(24, 0.3), 0.0), coarse = surface_of(wavy(5, 0.3, 0.2), 0.0);
  for (const auto& [from, to] : {std::pair(&fine, &coarse), std::pair(&coarse, &fine)}) {
    const double sampled = sampled_deviation(*from, *to, 3000);
    double before = std::numeric_limits<double>::infinity();
    for (const std::uint64_t pieces : {0, 100, 1000, 100'000}) {
      DeviationLimits limits;
      limits.pieces = pieces;
      const Deviation found = deviation(*from, SurfaceTree(*to), limits);
      EXPECT_GE(found.bound_m, sampled) << pieces;
      EXPECT_LE(found.found_m, found.bound_m) << pieces;
      EXPECT_LE(found.bound_m, before * (1.0 + 1e-12)) << pieces;
      before = found.bound_m;
    }
    EXPECT_LE(before, 1.25 * sampled * 1.1);
  }
}

TEST(SurfaceDeviation, OfWhatIsNoNumberIsInfinite) {
  const Mesh mesh = wavy(4, 0.1);
  const Surface sound = surface_of(mesh, 1.0);
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Mesh broken = mesh, broken_uv = mesh;
    broken.positions[mesh.indices[4]].y = wrong;
    broken_uv.uvs[mesh.indices[4]].x = wrong;
    for (const Surface& surface : {surface_of(broken, 1.0), surface_of(broken_uv, 1.0)}) {
      EXPECT_TRUE(std::isinf(deviation(sound, SurfaceTree(surface), {}).bound_m));
      EXPECT_TRUE(std::isinf(deviation(surface, SurfaceTree(sound), {}).bound_m));
      EXPECT_TRUE(std::isinf(ComparedSurface(sound).deviation_both_ways(ComparedSurface(surface), {}).bound_m));
      EXPECT_TRUE(std::isinf(ComparedSurface(surface).deviation_both_ways(ComparedSurface(sound), {}).bound_m));
    }
  }
}

TEST(SurfaceDeviation, BothWaysIsTheGreaterOneAndItselfIsNothing) {
  const Surface whole = surface_of(wavy(8, 0.1), 0.0);
  Surface half = whole;
  half.triangles.resize(whole.triangles.size() / 2);
  EXPECT_EQ(ComparedSurface(half).deviation_both_ways(ComparedSurface(half), {}).bound_m, 0.0);
  const double missing = deviation(whole, SurfaceTree(half), {}).found_m;
  EXPECT_GT(missing, 0.1);
  EXPECT_NEAR(ComparedSurface(half).deviation_both_ways(ComparedSurface(whole), {}).found_m, missing, 1e-12);
  EXPECT_NEAR(ComparedSurface(whole).deviation_both_ways(ComparedSurface(half), {}).found_m, missing, 1e-12);
}

TEST(SurfaceDeviation, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  const WorkBudget budget(&stop);
  DeviationLimits limits;
  limits.budget = &budget;
  const Surface surface = surface_of(wavy(4, 0.1), 0.0);
  EXPECT_THROW((void)deviation(surface, SurfaceTree(surface), limits), Failure);
}

TEST(SurfaceDeviation, FromNothingAndToNothing) {
  const Surface surface = surface_of(wavy(3, 0.1), 0.0);
  EXPECT_EQ(deviation({}, SurfaceTree(surface), {}).bound_m, 0.0);
  EXPECT_TRUE(std::isinf(deviation(surface, SurfaceTree({}), {}).bound_m));
}

}  // namespace
}  // namespace standin
