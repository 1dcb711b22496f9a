// A perspective image of small surface patches: how many pixels they generate, and how long their triangles' edges are in it.
//
// A patch of vector area a at eye-space point p, depth z, covers f^2 |a.p| / z^3 pixels: the exact differential of the projection, which
// takes in distance, orientation and the growth towards the image's corners at once. Edges of length l in all directions of its plane are
// f l (1 + |cos|) / 2z pixels long, where cos is that of the angle between the patch's normal and the line of sight.
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
    const double softening_m2 = glm::length(vector_area_m2) / 3.14159265358979323846;
    return focal_px * focal_px * std::abs(glm::dot(vector_area_m2, eye_point)) / (depth * (depth * depth + softening_m2));
  }
  [[nodiscard]] double edge_pixels(const Vec3& eye_point, const Vec3& vector_area_m2, double edges_m) const {
    const double scale = glm::length(vector_area_m2) * glm::length(eye_point);
    const double cosine = scale > 0.0 ? std::min(1.0, std::abs(glm::dot(vector_area_m2, eye_point)) / scale) : 0.0;
    return 0.5 * (1.0 + cosine) * edges_m * focal_px / -eye_point.z;
  }
};

/// What a patch seen from anywhere in a box may be at most.
struct MostInImage {
  bool faces = false;  // some eye
  double pixels = 0.0;
  double edge_pixels = 0.0;
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

  [[nodiscard]] MostInImage most(const Vec3& point, const Vec3& vector_area_m2, double edges_m, bool double_sided) const {
    // An estimate adds the same terms in another order and from transformed points.
    constexpr double kRounding = 1.0 + 1e-9;
    const double area_m2 = glm::length(vector_area_m2);
    const double from_centre = glm::dot(vector_area_m2, centre_ - point);
    const double towards = (double_sided ? std::abs(from_centre) : from_centre) + glm::dot(glm::abs(vector_area_m2), half_size_);
    const double nearest_m = std::max(distance(point, eyes_), near_m_);
    if (!double_sided && !(towards > -1e-9 * area_m2 * nearest_m)) return {};
    const double least_depth_m = cosine_ * nearest_m;
    const double facing_m2 = std::min(std::max(towards, 0.0), area_m2 * nearest_m);
    const double softening_m2 = area_m2 / 3.14159265358979323846;
    const double cosine = area_m2 > 0.0 ? std::min(1.0, facing_m2 / (area_m2 * nearest_m)) : 0.0;
    return {true, kRounding * focal_px_ * focal_px_ * facing_m2 / (least_depth_m * (least_depth_m * least_depth_m + softening_m2)),
            kRounding * 0.5 * (1.0 + cosine) * edges_m * focal_px_ / least_depth_m};
  }

 private:
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
