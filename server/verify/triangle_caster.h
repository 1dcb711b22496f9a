// One impostor of the GLB as its triangles, for rays: which opaque point does a ray meet first? The same for quads on layers and for
// meshes.
//
// Watertight: no ray passes between triangles that share two vertices (Woop, Benthin and Wald 2013: vertices are sheared along the ray, so
// that both triangles see their common edge with the same two products; here in double, without contraction, edges belong to both sides).
// Quads of a layer meet in T-junctions and were rounded to float each on its own: triangles also reach beyond their edges by
// kEdgeTolerance of their size, which closes those slits. A tree of boxes of our own instead of Embree's: its float distances would decide
// on which side of a slab's border a point lies, and on which texel.
//
// A texel coordinate is affine on a triangle as it lies in the world (any viewer interpolates it so), seen from both sides.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "server/verify/alpha_sampling.h"
#include "server/verify/glb_quads.h"
#include "server/verify/pixel_rays.h"

namespace standin {

class TriangleCaster {
 public:
  static constexpr double kEdgeTolerance = 1e-5;  // in barycentric coordinates

  /// `quads` and `impostor`, one of its own, must outlive the caster. Triangles without area show nothing. `mipmapped`: whether kMipmapped
  /// will be asked for.
  TriangleCaster(const GlbQuads& quads, const GlbImpostor& impostor, bool mipmapped);

  struct Shown {
    std::uint32_t triangle = 0;  // of the impostor
    double distance_m = 0.0;     // along the ray
    Vec3 point{0.0};             // world
  };
  /// The nearest point in front of the ray's origin where a triangle is opaque; of coincident ones that of the first triangle.
  [[nodiscard]] std::optional<Shown> first_opaque(const PixelRay& ray, AlphaSampling sampling) const;

  /// How the world position changes from texel to texel along a row, and down a column; zero where the texels of the triangle lie in a
  /// line.
  [[nodiscard]] std::pair<Vec3, Vec3> texel_steps(std::uint32_t triangle) const;

 private:
  struct Triangle {
    std::array<Vec3, 3> corners{};  // from the impostor's origin
    Vec3 texel_x_per_m{0.0};        // gradients of the texel coordinates in the triangle's plane
    Vec3 texel_y_per_m{0.0};
    Vec3 normal{0.0};     // not of unit length
    Vec2 texel_min{0.0};  // the triangle's texels: a point on its border belongs to none beyond
    Vec2 texel_max{0.0};  // exclusive
    std::uint32_t source = 0;
  };
  struct Node {
    Box box;
    std::uint32_t first = 0;  // triangle, or the second child (the first one follows its parent)
    std::uint32_t count = 0;  // triangles; 0: an inner node
  };
  struct Query;

  [[nodiscard]] std::optional<Triangle> prepared(std::uint32_t source) const;
  [[nodiscard]] static Box box_of(const Triangle& triangle);
  void sort_along(int axis, std::uint32_t first, std::uint32_t last);
  [[nodiscard]] std::pair<std::uint32_t, double> best_split(std::uint32_t first, std::uint32_t last) const;
  void build(std::uint32_t first, std::uint32_t last, int depth);
  [[nodiscard]] Vec2 texel_at(const Triangle& triangle, const Vec3& point) const;
  [[nodiscard]] double footprint_texels(const Triangle& triangle, const Query& query, const Vec2& texel) const;
  [[nodiscard]] bool is_opaque(const Triangle& triangle, const Query& query, const Vec3& point) const;
  void try_triangle(const Triangle& triangle, Query& query) const;

  const GlbImpostor& impostor_;
  std::vector<AlphaPage> pages_;
  std::vector<Triangle> triangles_;  // in the order of the tree's leaves
  std::vector<Node> nodes_;
};

}  // namespace standin
