// Depth meshes on small lattices: watertight, covering, manifold; and their textures.
#include <gtest/gtest.h>

#include <map>

#include "render/impostor/bake_depth_mesh.h"
#include "render/impostor/border_margin.h"
#include "render/impostor/depth_mesh_simplify.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

std::vector<BitImage> random_stack(Rng& rng, std::uint32_t side, std::size_t layers, double share) {
  std::vector<BitImage> stack(layers, BitImage(side, side));
  for (BitImage& layer : stack)
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x)
        if (rng.uniform() < share) layer.set(x, y);
  return stack;
}

const SurfaceDepth kAtPlane = [](std::uint32_t, std::uint32_t, std::uint32_t layer) { return static_cast<double>(layer); };

SimplifiedDepthMesh simplified(const DepthMesh& mesh, const VoxelLattice& lattice, double enlargement) {
  return simplify(mesh, lattice, uniform_depths(lattice.layers.size()), kAtPlane, enlargement);
}

Vec3 place(const LatticeVertex& v) {
  return {texel_coordinates(v), 0.5 * v.depth};
}

using Polygon = std::vector<Vec3>;

/// Clips a convex polygon to the closed half-space sign * p[axis] <= sign * limit.
Polygon clipped(const Polygon& in, int axis, double sign, double limit) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 &a = in[i], &b = in[(i + 1) % in.size()];
    const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
    if (da <= 1e-7) out.push_back(a);
    if ((da < -1e-7 && db > 1e-7) || (da > 1e-7 && db < -1e-7)) out.push_back(a + da / (da - db) * (b - a));
  }
  return out;
}

bool meets_box(Polygon polygon, const Vec3& centre, double half) {
  for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
    polygon = clipped(polygon, axis, 1.0, centre[axis] + half);
    polygon = clipped(polygon, axis, -1.0, centre[axis] - half);
  }
  return !polygon.empty();
}

/// Whether the segment crosses one of the mesh's polygons (axis-parallel rectangles of the initial mesh).
bool blocked(const DepthMesh& mesh, const Vec3& from, const Vec3& to) {
  for (const DepthPolygon& p : mesh.polygons) {
    Vec3 low(1e9), high(-1e9);
    for (const std::uint32_t v : p.corners) {
      low = glm::min(low, place(mesh.vertices[v]));
      high = glm::max(high, place(mesh.vertices[v]));
    }
    double enter = 0.0, leave = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double way = to[axis] - from[axis];
      if (std::abs(way) < 1e-12) {
        if (from[axis] < low[axis] || from[axis] > high[axis]) enter = 2.0;
        continue;
      }
      const double a = (low[axis] - from[axis]) / way, b = (high[axis] - from[axis]) / way;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave) return true;
  }
  return false;
}

bool opaque_cell_at(const BitImage& opaque, double x, double y) {
  const auto cell_x = static_cast<int>(std::floor(2.0 * (x - 0.25))), cell_y = static_cast<int>(std::floor(2.0 * (y - 0.25)));
  const int columns = 2 * static_cast<int>(opaque.width()) - 1, rows = 2 * static_cast<int>(opaque.height()) - 1;
  if (cell_x < 0 || cell_y < 0 || cell_x >= columns || cell_y >= rows) return false;
  for (const int j : {cell_y / 2, (cell_y + 1) / 2})
    for (const int i : {cell_x / 2, (cell_x + 1) / 2})
      if (!opaque.test(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j))) return false;
  return true;
}

TEST(DepthMesh, NoRayReachesAnOpaqueCellUnblocked) {
  Rng rng(1);
  int reached = 0;
  for (int stack = 0; stack < 25; ++stack) {
    const auto opaque = random_stack(rng, 6, 5, rng.uniform(0.3, 0.9));
    const DepthMesh mesh = initial_depth_mesh(unculled_lattice(opaque), Sheets::kAll);
    for (int ray = 0; ray < 60; ++ray) {
      Vec3 at(rng.uniform(0.0, 6.0), rng.uniform(0.0, 6.0), 0.0);
      bool stopped = opaque_cell_at(opaque[0], at.x, at.y);
      for (std::size_t k = 1; k < opaque.size() && !stopped; ++k) {
        const Vec3 next = at + Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), 1.0);
        stopped = blocked(mesh, at + Vec3(0, 0, 1e-9), next);
        const bool opaque_here = opaque_cell_at(opaque[k], next.x, next.y);
        EXPECT_TRUE(stopped || !opaque_here) << "stack " << stack << " ray " << ray << " layer " << k;
        reached += opaque_here;
        at = next;
      }
    }
  }
  EXPECT_GT(reached, 300);
}

std::map<std::pair<std::uint32_t, std::uint32_t>, int> triangles_per_edge(const SimplifiedDepthMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const TriangleCorners& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) ++count[std::minmax(t[i], t[(i + 1) % 3])];
  return count;
}

TEST(DepthMesh, SimplificationCoversEveryVoxelAndNothingElse) {
  Rng rng(2);
  for (int stack = 0; stack < 20; ++stack)
    for (const double enlargement : {1.0, 1.5}) {
      const VoxelLattice lattice = unculled_lattice(random_stack(rng, 8, 4, rng.uniform(0.4, 0.97)));
      const DepthMesh initial = initial_depth_mesh(lattice, Sheets::kAll);
      const SimplifiedDepthMesh mesh = simplified(initial, lattice, enlargement);
      EXPECT_LT(mesh.triangles.size(), 2 * initial.polygons.size() + 1);
      const auto meets = [&](std::uint32_t x, std::uint32_t y, std::size_t k) {
        return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const TriangleCorners& t) {
          return meets_box({place(mesh.vertices[t[0]]), place(mesh.vertices[t[1]]), place(mesh.vertices[t[2]])},
                           {x + 0.5, y + 0.5, static_cast<double>(k)}, 0.5 * enlargement);
        });
      };
      for (std::size_t k = 0; k < lattice.layers.size(); ++k)
        for (std::uint32_t y = 0; y < 8; ++y)
          for (std::uint32_t x = 0; x < 8; ++x) {
            const bool shown = std::any_of(initial.polygons.begin(), initial.polygons.end(), [&](const DepthPolygon& p) {
              return p.layer == static_cast<int>(k) && (p.cell_x / 2 == static_cast<int>(x) || (p.cell_x + 1) / 2 == static_cast<int>(x)) &&
                     (p.cell_y / 2 == static_cast<int>(y) || (p.cell_y + 1) / 2 == static_cast<int>(y));
            });
            if (shown) {
              EXPECT_TRUE(meets(x, y, k)) << "stack " << stack << ": " << x << ' ' << y << ' ' << k;
            }
          }
      for (const auto& [edge, count] : triangles_per_edge(mesh))
        for (int i = 0; i <= 16; ++i) {
          const Vec3 p = glm::mix(place(mesh.vertices[edge.first]), place(mesh.vertices[edge.second]), i / 16.0);
          bool within = false;
          for (std::size_t k = 0; k < lattice.layers.size(); ++k)
            for (std::uint32_t y = 0; y < 8; ++y)
              for (std::uint32_t x = 0; x < 8; ++x)
                within = within || (lattice.layers[k].opaque.test(x, y) && std::abs(p.x - x - 0.5) <= 0.5 * enlargement + 1e-7 &&
                                    std::abs(p.y - y - 0.5) <= 0.5 * enlargement + 1e-7 &&
                                    std::abs(p.z - static_cast<double>(k)) <= 0.5 * enlargement + 1e-7);
          EXPECT_TRUE(within) << "stack " << stack;
        }
    }
}

TEST(DepthMesh, AFullLayerIsTwoTriangles) {
  BitImage full(40, 30);
  for (std::uint32_t y = 0; y < 30; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) full.set(x, y);
  const VoxelLattice lattice = voxel_lattice({full, full, full}, 2);
  const DepthMesh initial = initial_depth_mesh(lattice, Sheets::kSeen);
  EXPECT_EQ(initial.meshes, 1U);
  EXPECT_LE(simplified(initial, lattice, 1.0).triangles.size(), 14U);  // the border of the second layer is seen past the first's
  const VoxelLattice one = voxel_lattice({full}, 2);
  const SimplifiedDepthMesh mesh = simplified(initial_depth_mesh(one, Sheets::kSeen), one, 1.0);
  ASSERT_EQ(mesh.triangles.size(), 2U);
  Vec2 low(1e9), high(-1e9);
  for (const LatticeVertex& v : mesh.vertices) low = glm::min(low, texel_coordinates(v)), high = glm::max(high, texel_coordinates(v));
  EXPECT_EQ(low, Vec2(0.25));
  EXPECT_EQ(high, Vec2(39.75, 29.75));
}

TEST(DepthMesh, SmallestInputs) {
  BitImage none(5, 4), voxel(5, 4);
  voxel.set(2, 1);
  const VoxelLattice empty = voxel_lattice({none, none}, 2);
  EXPECT_TRUE(initial_depth_mesh(empty, Sheets::kSeen).polygons.empty());
  EXPECT_EQ(initial_depth_mesh(empty, Sheets::kSeen).meshes, 0U);
  EXPECT_TRUE(simplified(initial_depth_mesh(empty, Sheets::kSeen), empty, 1.0).triangles.empty());
  const VoxelLattice single = voxel_lattice({none, voxel}, 2);
  const std::size_t triangles = simplified(initial_depth_mesh(single, Sheets::kSeen), single, 1.5).triangles.size();
  EXPECT_TRUE(triangles == 1 || triangles == 2);
}

ViewCell shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

// Holes may close in the simplification, but not where one sees through them.
TEST(DepthMesh, AnOpenHoleStaysOpen) {
  BitImage holed(20, 20);
  for (std::uint32_t y = 0; y < 20; ++y)
    for (std::uint32_t x = 0; x < 20; ++x)
      if (x < 8 || x > 10 || y < 8 || y > 10) holed.set(x, y);
  const VoxelLattice lattice = voxel_lattice({holed}, 2);
  const SimplifiedDepthMesh mesh = simplified(initial_depth_mesh(lattice, Sheets::kSeen), lattice, 1.4);
  EXPECT_GE(mesh.triangles.size(), 6U);
  const Vec2 middle(9.5);
  for (const TriangleCorners& t : mesh.triangles) {
    int left = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2 from = texel_coordinates(mesh.vertices[t[i]]), to = texel_coordinates(mesh.vertices[t[(i + 1) % 3]]);
      left += (to.x - from.x) * (middle.y - from.y) > (to.y - from.y) * (middle.x - from.x);
    }
    EXPECT_TRUE(left != 0 && left != 3);
  }
}

TEST(DepthMesh, BordersAreWidenedInTheirPlane) {
  BitImage full(10, 8);
  for (std::uint32_t y = 0; y < 8; ++y)
    for (std::uint32_t x = 0; x < 10; ++x) full.set(x, y);
  const VoxelLattice lattice = voxel_lattice({full}, 2);
  SimplifiedDepthMesh mesh = simplified(initial_depth_mesh(lattice, Sheets::kSeen), lattice, 1.0);
  widen_borders(mesh, 0.25);
  Vec3 low(1e9), high(-1e9);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    low = glm::min(low, shifted_place(mesh, v)), high = glm::max(high, shifted_place(mesh, v));
  EXPECT_LT(glm::length(low - Vec3(0.0)), 1e-9);
  EXPECT_LT(glm::length(high - Vec3(10.0, 8.0, 0.0)), 1e-9);
}

DepthMeshImpostor baked(const Scene& scene, const ViewCell& cell, const DepthMeshQuality& quality = {}) {
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) objects.push_back(i);
  return bake_depth_mesh(scene, TexturePyramids(scene), {objects, cell}, Camera{}, {}, quality);
}

TEST(DepthMesh, ASlantedPlaneOfManyLayersIsAFewTriangles) {
  test::SmallScene scene;
  scene.add_object(test::rectangle({-4, -3, 0}, {8, 0, 0}, {0, 6, -10}));
  const DepthMeshImpostor impostor = baked(scene.scene, shaft_towards_z(0.2, 30.0));
  EXPECT_GT(impostor.summary.layers, 15U);
  EXPECT_EQ(impostor.summary.meshes, 1U);
  EXPECT_LE(impostor.summary.triangles, 100U);  // of some hundred thousand
}

// A checkerboard of 1 m squares on a plane that recedes: every texel well inside a square has its colour.
TEST(DepthMesh, TexelsHaveTheColourOfTheirPlaceInTheWorld) {
  test::SmallScene scene;
  scene.scene.textures.push_back({"board", 2, 2, {255, 0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 255, 255, 0, 0, 255}});
  Material material = test::SmallScene::white();
  material.texture = 0;
  scene.add_object(test::rectangle({-4, -3, 0}, {8, 0, 0}, {0, 6, -6}), material, test::rectangle_uvs(Vec2(4.0, 3.0)));
  const DepthMeshImpostor impostor = baked(scene.scene, shaft_towards_z(0.1, 30.0));
  const TexturedMesh& mesh = impostor.mesh;
  std::size_t block = 0;
  int judged = 0;
  for (const Chart& chart : mesh.charts) {
    for (std::uint32_t i = 0; i < chart.index_count; i += 3) {
      std::array<ImpostorVertex, 3> v;
      for (std::uint32_t k = 0; k < 3; ++k) v[k] = mesh.vertices[chart.first_vertex + mesh.indices[chart.first_index + i + k]];
      for (int step = 0; step < 40; ++step) {
        const double a = (step % 8 + 0.5) / 9.0, b = (1.0 - a) * (step / 8 + 0.5) / 5.0;
        const Vec2 texel = v[0].texel + a * (v[1].texel - v[0].texel) + b * (v[2].texel - v[0].texel);
        const Vec3 point =
            impostor.frame.reference_viewpoint + v[0].offset + a * (v[1].offset - v[0].offset) + b * (v[2].offset - v[0].offset);
        const std::size_t at = block + 4 * (static_cast<std::size_t>(texel.y) * chart.width + static_cast<std::size_t>(texel.x));
        EXPECT_EQ(impostor.texels[at + 3], 255);
        const double u = point.x + 4.0, w = point.y + 3.0;  // squares' sides are integers
        if (std::abs(u - std::round(u)) < 0.3 || std::abs(w - std::round(w)) < 0.3 || w < 0.0 || w > 6.0 || u < 0.0 || u > 8.0) continue;
        const bool red = (static_cast<int>(u) + static_cast<int>(w)) % 2 == 0;
        EXPECT_EQ(impostor.texels[at] > 128, red) << u << ' ' << w;
        ++judged;
      }
    }
    block += 4 * std::size_t{chart.width} * chart.height;
  }
  EXPECT_EQ(block, impostor.texels.size());
  EXPECT_GT(judged, 20);
}

TEST(DepthMesh, OneTexelAndTheSameBytesTwice) {
  test::SmallScene speck;
  speck.add_object(test::rectangle({0.3, 0.2, 0}, {0.01, 0, 0}, {0, 0.01, 0}));
  const DepthMeshImpostor one = baked(speck.scene, shaft_towards_z(0.1, 40.0));
  EXPECT_GE(one.summary.triangles, 1U);
  EXPECT_LE(one.texels.size(), 16U);  // one and a half texels a side, with the margin

  Rng rng(3);
  test::SmallScene scene;
  scene.add_object(test::random_triangles(rng, {Vec3(-4, -3, -5), Vec3(4, 3, 5)}, 6));
  const DepthMeshImpostor a = baked(scene.scene, shaft_towards_z(0.1, 60.0)), b = baked(scene.scene, shaft_towards_z(0.1, 60.0));
  EXPECT_FALSE(a.texels.empty());
  EXPECT_EQ(a.texels, b.texels);
  EXPECT_EQ(a.mesh.indices, b.mesh.indices);
}

}  // namespace
}  // namespace standin
