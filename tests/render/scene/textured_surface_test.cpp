// A picture slips by no more than a level's error says, whatever it is stretched by; colours keep their borders.

#include "render/scene/textured_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "render/base/rng.h"
#include "render/scene/level_errors.h"
#include "render/scene/simplify_mesh.h"
#include "tests/render/scene/level_meshes.h"

namespace standin {
namespace {

using UvAt = std::function<Vec2(double x, double z)>;
using ColourAt = std::function<Vec2(double x, double z)>;

/// A flat board of `n` by `n` squares, whose picture lies as `uv` says.
Mesh board(int n, const UvAt& uv) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n, z = static_cast<double>(j) / n;
      mesh.positions.emplace_back(x, 0.0, z);
      mesh.normals.emplace_back(0.0, 1.0, 0.0);
      mesh.uvs.emplace_back(uv(x, z));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto v = static_cast<std::uint32_t>(j * (n + 1) + i), w = v + static_cast<std::uint32_t>(n) + 1;
      mesh.indices.insert(mesh.indices.end(), {v, w, v + 1, v + 1, w, w + 1});
    }
  update_derived(mesh);
  return mesh;
}

/// A board each of whose triangles wears the one colour that is at its middle.
Mesh palette_board(int n, const ColourAt& colour) {
  const Mesh whole = board(n, [](double, double) { return Vec2(0.0); });
  Mesh mesh;
  for (std::size_t i = 0; i < whole.indices.size(); i += 3) {
    Vec3 middle(0.0);
    for (std::size_t c = 0; c < 3; ++c) middle += Vec3(whole.positions[whole.indices[i + c]]) / 3.0;
    for (std::size_t c = 0; c < 3; ++c) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(whole.positions[whole.indices[i + c]]);
      mesh.normals.push_back(whole.normals[whole.indices[i + c]]);
      mesh.uvs.emplace_back(colour(middle.x, middle.z));
    }
  }
  update_derived(mesh);
  return mesh;
}

struct Sample {
  Vec3 place;
  Vec2 uv;
};

std::vector<Sample> samples_of(const Mesh& mesh, int count) {
  Rng rng(11);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    const std::size_t t = rng.below(mesh.triangle_count());
    const double root = std::sqrt(rng.uniform()), s = rng.uniform();
    const double weights[] = {1.0 - root, root * (1.0 - s), root * s};
    Sample sample{Vec3(0.0), Vec2(0.0)};
    for (std::size_t c = 0; c < 3; ++c) {
      sample.place += weights[c] * Vec3(mesh.positions[mesh.indices[3 * t + c]]);
      sample.uv += weights[c] * Vec2(mesh.uvs[mesh.indices[3 * t + c]]);
    }
    samples.push_back(sample);
  }
  return samples;
}

using UvTriangle = std::array<std::array<float, 5>, 3>;
UvTriangle triangle(const Mesh& mesh, std::size_t t) {
  UvTriangle corners;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t v = mesh.indices[3 * t + c];
    corners[c] = {mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z, mesh.uvs[v].x, mesh.uvs[v].y};
  }
  std::ranges::sort(corners);
  return corners;
}

bool is_of_one_colour(const UvTriangle& t) {
  return t[0][3] == t[1][3] && t[1][3] == t[2][3] && t[0][4] == t[1][4] && t[1][4] == t[2][4];
}

/// From a point to the nearest triangle that wears one colour.
double distance_to_colour(const Sample& sample, const Mesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    SurfaceTriangle corners;
    bool same = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = mesh.indices[3 * t + c];
      corners[c] = {mesh.positions[v], Vec2(0.0)};
      same = same && glm::distance(Vec2(mesh.uvs[v]), sample.uv) < 1e-5;  // samples are mixed of three equal ones
    }
    if (same) least = std::min(least, distance({sample.place, Vec2(0.0)}, corners));
  }
  return least;
}

TEST(TexturedSurface, StretchIsThatOfTheWorstDirection) {
  const std::array<Vec3, 3> places{Vec3(0.0), Vec3(2.0, 0.0, 0.0), Vec3(0.0, 0.0, 3.0)};
  EXPECT_DOUBLE_EQ(metres_per_uv(places, {Vec2(0.0), Vec2(1.0, 0.0), Vec2(0.0, 1.0)}), 3.0);
  EXPECT_DOUBLE_EQ(metres_per_uv(places, {Vec2(0.0), Vec2(0.5, 0.0), Vec2(0.0, 1.0)}), 4.0);
  EXPECT_DOUBLE_EQ(metres_per_uv({Vec3(0.0), Vec3(1.0, 0.0, 0.0), Vec3(1.0, 0.0, 1.0)}, {Vec2(0.0), Vec2(0.5, 0.5), Vec2(0.0, 1.0)}),
                   std::sqrt(2.0));
  EXPECT_TRUE(std::isinf(metres_per_uv(places, {Vec2(0.0), Vec2(1.0, 1.0), Vec2(2.0, 2.0)})));
}

// u grows by 10 a metre as far as x = 0.9, and by a third of that beyond, where the picture is stretched.
double uneven(double x) {
  return x < 0.9 ? 10.0 * x : 9.0 + (10.0 / 3.0) * (x - 0.9);
}
double place_of(double u) {
  return u < 9.0 ? u / 10.0 : 0.9 + 0.3 * (u - 9.0);
}

TEST(TexturedSurface, SlipIsWithinTheErrorWhereTilingIsUneven) {
  const auto wavy = [](double x, double z) { return Vec2(uneven(x) + 0.3 * std::sin(9.0 * z) * (x > 0.9 ? 1.0 : 0.0), 10.0 * z); };
  const Mesh mesh = board(30, wavy);
  std::size_t levels = 0;
  for (const SimplifiedMesh& level : simplified(mesh, {})) {
    ++levels;
    for (const Sample& sample : samples_of(level.mesh, 20'000)) {
      // Under the original's own map: what is shown here belongs there.
      const double bend = sample.place.x > 0.9 ? 0.3 * std::sin(9.0 * sample.place.z) : 0.0;
      if (std::abs(sample.place.x - 0.9) < 0.04) continue;  // the one column that has both kinds of picture
      const double slip_m = std::hypot(place_of(sample.uv.x - bend) - sample.place.x, sample.uv.y / 10.0 - sample.place.z);
      ASSERT_LE(slip_m, level.error_m + 1.5e-3) << "at " << sample.place.x << ", " << sample.place.z;
    }
  }
  EXPECT_GT(levels, 0U);
}

// Beyond x = 0.8 the picture's columns are drawn out to lines: there it has no size, and none may be made up.
TEST(TexturedSurface, TrianglesWithoutAPicturesAreaStayAsTheyAre) {
  const Mesh mesh = board(20, [](double x, double z) { return Vec2(std::min(x, 0.8), z); });
  std::set<UvTriangle> drawn_out;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    if (const auto corners = triangle(mesh, t); corners[0][3] == corners[1][3] && corners[1][3] == corners[2][3]) drawn_out.insert(corners);
  ASSERT_EQ(drawn_out.size(), 4U * 20U * 2U);
  const auto levels = simplified(mesh, {});
  ASSERT_FALSE(levels.empty());
  for (const SimplifiedMesh& level : levels) {
    std::set<UvTriangle> shown;
    for (std::size_t t = 0; t < level.mesh.triangle_count(); ++t) shown.insert(triangle(level.mesh, t));
    EXPECT_TRUE(std::ranges::includes(shown, drawn_out));
  }
  Scene scene = test::scene_of_placed({mesh}, {{0, Mat4(1.0)}});
  (void)add_object_levels(scene, test::kLevelOptions, WorkBudget());
  ASSERT_FALSE(scene.objects[0].levels.empty());
  EXPECT_TRUE(level_faults(scene, test::kLevelOptions, WorkBudget()).empty());
  Mesh& shown = scene.meshes[scene.parts[scene.objects[0].levels[0].first_part].mesh];
  for (std::size_t v = 0; v < shown.positions.size(); ++v)
    if (shown.positions[v].x == 1.0F) shown.uvs[v].y += 0.02F;
  EXPECT_FALSE(level_faults(scene, test::kLevelOptions, WorkBudget()).empty());
}

TEST(TexturedSurface, ColoursOfAPaletteKeepTheirBordersWithinTheError) {
  const auto colour = [](double x, double z) { return x < 0.5 + 0.1 * std::sin(12.0 * z) ? Vec2(0.25, 0.5) : Vec2(0.75, 0.5); };
  const Mesh mesh = palette_board(24, colour);
  std::size_t levels = 0;
  for (const SimplifiedMesh& level : simplified(mesh, {})) {
    ++levels;
    for (std::size_t t = 0; t < level.mesh.triangle_count(); ++t) ASSERT_TRUE(is_of_one_colour(triangle(level.mesh, t)));
    for (const auto& [from, to] : {std::pair(&mesh, &level.mesh), std::pair(&level.mesh, &mesh)})
      for (const Sample& sample : samples_of(*from, 2000)) ASSERT_LE(distance_to_colour(sample, *to), level.error_m * (1.0 + 1e-6) + 1e-6);
  }
  EXPECT_GT(levels, 0U);
}

// One square of another colour, moved by one square; one that mixes two; one that is gone.
TEST(TexturedSurface, AColourElsewhereMixedOrGoneIsFarOff) {
  const auto with_spot = [](double left) {
    return [left](double x, double z) { return x > left && x < left + 0.1 && z > 0.4 && z < 0.5 ? Vec2(0.75, 0.5) : Vec2(0.25, 0.5); };
  };
  const Mesh mesh = palette_board(10, with_spot(0.4));
  const TexturedSurface original(mesh, true);
  EXPECT_EQ(original.deviation_of(mesh, {}, 20.0).bound_m, 0.0);
  EXPECT_NEAR(original.deviation_of(palette_board(10, with_spot(0.5)), {}, 20.0).found_m, 0.1, 0.01);
  Mesh mixed = mesh;
  mixed.uvs[0] = {0.75F, 0.5F};
  EXPECT_TRUE(std::isinf(original.deviation_of(mixed, {}, 20.0).bound_m));
  EXPECT_TRUE(std::isinf(original.deviation_of(palette_board(10, [](double, double) { return Vec2(0.25, 0.5); }), {}, 20.0).bound_m));
}

TEST(TexturedSurface, CoordinatesThatNoTextureWearsMeanNothing) {
  const Mesh mesh = board(10, [](double x, double) { return Vec2(x < 0.5 ? 0.0 : 1.0, 0.0); });
  Mesh other = mesh;
  for (glm::vec2& uv : other.uvs) uv += 0.5F;
  EXPECT_EQ(TexturedSurface(mesh, false).deviation_of(other, {}, 20.0).bound_m, 0.0);
  EXPECT_GT(TexturedSurface(mesh, true).deviation_of(other, {}, 20.0).bound_m, 0.1);
}

}  // namespace
}  // namespace standin
