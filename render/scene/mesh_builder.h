// Builds procedural meshes out of patches, boxes, lathes, tubes and free surfaces, with normals and texture coordinates.
//
// Corners run counter-clockwise seen from outside. `nu` and `nv` are numbers of cells, so each call costs 2 * nu * nv triangles.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// Rectangle in texture space: `from` at the first corner, `to` at the opposite one.
struct UvRect {
  glm::dvec2 from{0.0, 0.0};
  glm::dvec2 to{1.0, 1.0};
};

/// One step of a lathe's profile.
struct Ring {
  double radius_m = 0.0;
  double height_m = 0.0;
};

class MeshBuilder {
 public:
  [[nodiscard]] std::size_t triangle_count() const { return mesh_.triangle_count(); }

  /// Flat quadrilateral a b c d; texture u runs along ab, v from d (top) to a (bottom).
  void patch(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int nu = 1, int nv = 1, const UvRect& uv = {});
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c);
  /// A level triangle whose texture lies fixed in the plane, `repeats_per_m` to a metre.
  void level_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double repeats_per_m);
  /// Five faces (no bottom), `n` x `n` cells each: 10 n^2 triangles.
  void box(const Vec3& low, const Vec3& high, int n = 1);
  /// Smooth surface of revolution about the y axis through `foot`; 2 * segments * (rings - 1) triangles.
  void lathe(const Vec3& foot, const std::vector<Ring>& profile, int segments);
  /// Cone frustum from p to q: 2 * segments * rings triangles.
  void tube(const Vec3& p, const Vec3& q, double p_radius_m, double q_radius_m, int segments, int rings);
  /// Smooth parametric surface over [0,1]^2; the normal is du x dv.
  void surface(const std::function<Vec3(double u, double v)>& point, int nu, int nv, const UvRect& uv = {});
  /// A quadrilateral whose four corners share `normal` (leaves are lit like the crown they belong to).
  void card(const Vec3& centre, const Vec3& half_u, const Vec3& half_v, const Vec3& normal);

  [[nodiscard]] Mesh finish(const std::string& name);

 private:
  std::uint32_t vertex(const Vec3& position, const Vec3& normal, const glm::dvec2& uv);
  void grid(std::uint32_t first, int nu, int nv);

  Mesh mesh_;
};

/// Every triangle into four, at its edges' midpoints.
[[nodiscard]] Mesh refined(const Mesh& mesh);

}  // namespace standin
