// How far a point seems to move when a coarse mesh stands for it: the error criterion of LOD-sprite (VIS'99; math.md 6.1, equation (1)).
//
// The image of the reference viewpoint v1 shows the original's point C where the mesh has C', on the ray from v1 through C. From another
// viewpoint v2 they are the angle C v2 C' apart; the criterion asks that this be less than eps pixels. As published it is asked of the last
// viewpoint; a baked impostor must stand for a whole view cell, so it is asked from all the cell's corners, and of the worst point instead
// of the mean square (2). Where the ray misses the mesh, as at outlines, C' is the mesh's point nearest to C.
#pragma once

#include <span>

#include "render/impostor/triangle_tree.h"

namespace standin {

/// Angle between two points seen from the viewpoint, radians; stable for small ones.
[[nodiscard]] double apparent_angle(const Vec3& viewpoint, const Vec3& a, const Vec3& b);
/// The largest from any of the viewpoints.
[[nodiscard]] double apparent_angle(std::span<const Vec3> viewpoints, const Vec3& a, const Vec3& b);

/// Whether the largest is below `limit_rad` (1.5 at most), as most callers ask: without an arc tangent.
[[nodiscard]] bool appears_within(std::span<const Vec3> viewpoints, const Vec3& a, const Vec3& b, double limit_rad);

/// Where the ray from the origin through `point` meets the triangle, as a multiple of `point`.
[[nodiscard]] std::optional<double> ray_meets(const std::array<Vec3, 3>& triangle, const Vec3& point);

/// All points from the reference viewpoint, which is the origin.
class SpriteError {
 public:
  /// `viewpoints` hold the origin too where outlines are to be right from there.
  SpriteError(std::vector<std::array<Vec3, 3>> coarse, const Vec3& forward, std::span<const Vec3> viewpoints);
  /// Whether every point appears within `limit_rad` of its place.
  [[nodiscard]] bool within(std::span<const Vec3> points, double limit_rad) const;

 private:
  [[nodiscard]] bool is_within(const Vec3& point, double limit_rad) const;
  [[nodiscard]] bool is_within_along_ray(const Vec3& point, double limit_rad) const;
  [[nodiscard]] Vec2 slope(const Vec3& point) const {
    return Vec2(glm::dot(point, right_), glm::dot(point, up_)) / glm::dot(point, forward_);
  }
  [[nodiscard]] std::array<int, 2> bin_of(const Vec2& slope) const;

  std::vector<std::array<Vec3, 3>> coarse_;
  TriangleTree tree_;
  Vec3 forward_, right_, up_;
  std::span<const Vec3> viewpoints_;
  Vec2 low_{std::numeric_limits<double>::infinity()};  // slopes of the mesh
  Vec2 high_{-std::numeric_limits<double>::infinity()};
  std::vector<std::vector<std::uint32_t>> bins_;  // triangles by their place in the image
};

}  // namespace standin
