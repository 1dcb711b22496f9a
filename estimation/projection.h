// A perspective image of small surface patches: how many pixels they generate, and how long their triangles' edges are in it.
//
// A patch of vector area a at eye-space point p, depth z, covers f^2 |a.p| / z^3 pixels: the exact differential of the projection, which
// takes in distance, orientation and the growth towards the image's corners at once. Edges of length l in all directions of its plane are
// f l (1 + |cos|) / 2z pixels long, where cos is that of the angle between the patch's normal and the line of sight. Both hold for patches
// that are small beside their distance; nearer ones are divided.
#pragma once

#include <cmath>

#include "render/view/camera.h"

namespace standin {

/// A view with what every object asks of it.
struct PreparedView {
  PreparedView(const View& view, const Camera& camera)
      : position(view.position),
        eye_from_world(glm::transpose(world_from_eye_rotation(view.direction))),
        frustum(frustum_of(view, camera)) {}
  Vec3 position;
  Mat3 eye_from_world;
  Frustum frustum;
};

/// A patch of surface in eye space.
struct Patch {
  Vec3 centre{0.0};
  Vec3 vector_area_m2{0.0};
  double edges_m = 0.0;
  double triangles = 0.0;
};

/// A patch nearer than this many of its radii is not small: it is taken as a grid of squares, and each of these again, kDeepestParts deep.
inline constexpr double kNearRadii = 4.0;
inline constexpr int kPartsPerSide = 4;
inline constexpr int kDeepestParts = 2;
/// Of a disc of the patch's area, squared.
[[nodiscard]] inline double radius2_m2(double area_m2) {
  return area_m2 / 3.14159265358979323846;
}
[[nodiscard]] inline bool is_small(double distance2_m2, double area_m2) {
  return distance2_m2 >= kNearRadii * kNearRadii * radius2_m2(area_m2);
}

/// Calls visit(part) for the patch, or for the parts of a square of its area around its centre that are small as seen from the origin.
template <class Visit>
void for_each_small_part(const Patch& patch, Visit&& visit, int depth = 0) {
  const double area_m2 = glm::length(patch.vector_area_m2);
  if (depth == kDeepestParts || is_small(glm::dot(patch.centre, patch.centre), area_m2)) return visit(patch);
  const Vec3 normal = patch.vector_area_m2 / area_m2;
  const Vec3 across = std::abs(normal.x) < 0.5 ? Vec3(1.0, 0.0, 0.0) : Vec3(0.0, 1.0, 0.0);
  const double step_m = std::sqrt(area_m2) / kPartsPerSide;
  const Vec3 u = step_m * glm::normalize(glm::cross(normal, across));
  const Vec3 v = glm::cross(normal, u);
  constexpr double kShare = 1.0 / (kPartsPerSide * kPartsPerSide);
  for (int i = 0; i < kPartsPerSide; ++i)
    for (int j = 0; j < kPartsPerSide; ++j) {
      const double x = i - 0.5 * (kPartsPerSide - 1), y = j - 0.5 * (kPartsPerSide - 1);
      for_each_small_part(
          Patch{patch.centre + x * u + y * v, kShare * patch.vector_area_m2, kShare * patch.edges_m, kShare * patch.triangles}, visit,
          depth + 1);
    }
}

struct Projection {
  explicit Projection(const Camera& camera)
      : focal_px(camera.focal_px()), tan_half_x(camera.tan_half_x()), tan_half_y(camera.tan_half_y()), near_m(camera.near_m) {}

  double focal_px, tan_half_x, tan_half_y, near_m;

  [[nodiscard]] bool sees(const Vec3& eye_point) const {
    const double depth = -eye_point.z;
    return depth >= near_m && std::abs(eye_point.x) <= tan_half_x * depth && std::abs(eye_point.y) <= tan_half_y * depth;
  }
  /// Of a patch it sees; a share of the patch's area in the denominator (as in the form factor of a disc) keeps near patches finite.
  [[nodiscard]] double pixels(const Vec3& eye_point, const Vec3& vector_area_m2) const {
    const double depth = -eye_point.z;
    const double softening_m2 = radius2_m2(glm::length(vector_area_m2));
    return focal_px * focal_px * std::abs(glm::dot(vector_area_m2, eye_point)) / (depth * (depth * depth + softening_m2));
  }
  [[nodiscard]] double edge_pixels(const Patch& patch) const {
    const double scale = glm::length(patch.vector_area_m2) * glm::length(patch.centre);
    const double cosine = scale > 0.0 ? std::min(1.0, std::abs(glm::dot(patch.vector_area_m2, patch.centre)) / scale) : 0.0;
    return 0.5 * (1.0 + cosine) * patch.edges_m * focal_px / -patch.centre.z;
  }
};

/// What a patch seen from anywhere in a box may be at most.
struct MostInImage {
  bool faces = false;         // some eye
  double reach_m = 0.0;       // of its parts from its centre; 0 where it is small
  double corner_depth_m = 0;  // least depth at which it can be seen
  double facing_px_m2 = 0.0;  // f^2 times the area that faces the eye
  double softening_m2 = 0.0;
  double edges_px_m = 0.0;

  [[nodiscard]] double pixels() const { return facing_px_m2 / (corner_depth_m * (corner_depth_m * corner_depth_m + softening_m2)); }
  [[nodiscard]] double edge_pixels() const { return edges_px_m / corner_depth_m; }
};

/// The same for all eyes in a box and all directions of view: an upper bound, and never less for a larger box.
///
/// With w from the patch to the eye, r = |w| >= its least value over the box, |a.w| at most the support of the box and at most |a| r, and
/// z >= r cos of the image's half diagonal for whatever is seen.
class ProjectionFromBox {
 public:
  ProjectionFromBox(const Camera& camera, const Box& eyes)
      : eyes_(eyes),
        centre_(eyes.centre()),
        half_size_(0.5 * eyes.size()),
        focal_px_(camera.focal_px()),
        cosine_(std::cos(camera.half_diagonal_rad())),
        near_m_(camera.near_m) {}

  [[nodiscard]] MostInImage most(const Patch& patch, bool double_sided) const {
    // An estimate adds the same terms in another order and from transformed points.
    constexpr double kRounding = 1.0 + 1e-9;
    const double area_m2 = glm::length(patch.vector_area_m2);
    const double from_centre = glm::dot(patch.vector_area_m2, centre_ - patch.centre);
    const double towards = (double_sided ? std::abs(from_centre) : from_centre) + glm::dot(glm::abs(patch.vector_area_m2), half_size_);
    const double to_centre_m = distance(patch.centre, eyes_);
    if (!double_sided && !(towards > -1e-9 * area_m2)) return {};
    // Parts lie in the patch's plane, within half the diagonal of the square; no part is smaller than the deepest ones.
    const bool small = is_small((1.0 - 1e-9) * to_centre_m * to_centre_m, area_m2);
    const double reach_m = small ? 0.0 : std::sqrt(0.5 * area_m2);
    const double nearest_m = std::max(to_centre_m - reach_m, near_m_);
    const double facing_m2 = std::min(std::max(towards, 0.0), area_m2 * nearest_m);
    const double softening_m2 = radius2_m2(small ? area_m2 : area_m2 * kDeepestShare);
    const double cosine = area_m2 > 0.0 ? std::min(1.0, facing_m2 / (area_m2 * nearest_m)) : 0.0;
    return {true,
            reach_m,
            cosine_ * nearest_m,
            kRounding * focal_px_ * focal_px_ * facing_m2,
            softening_m2,
            kRounding * 0.5 * (1.0 + cosine) * patch.edges_m * focal_px_};
  }

 private:
  static constexpr double kDeepestShare = 1.0 / 256.0;  // kPartsPerSide^-2 for each of kDeepestParts
  static_assert(kPartsPerSide == 4 && kDeepestParts == 2);

  Box eyes_;
  Vec3 centre_;
  Vec3 half_size_;
  double focal_px_, cosine_, near_m_;
};

/// The most pixels that a patch of 1 m^2 at 1 m covers anywhere in the image, facing the eye: f^2 / cos^3 of the half diagonal.
[[nodiscard]] inline double greatest_pixels_per_m2_at_1m(const Camera& camera) {
  return camera.focal_px() * camera.focal_px() * std::pow(std::cos(camera.half_diagonal_rad()), -3.0);
}

}  // namespace standin
