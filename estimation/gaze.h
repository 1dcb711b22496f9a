// Which points the views of a region may see, and how far from the middle of the image (thesis 5.5.2; math.md 4): the enclosing frustum of
// eyes in a box that look in an interval of directions, asked about the many surface samples of near objects.
//
// A sample is out where a plane of the enclosing frustum passes it. What is left is seen at an angle from the view's direction of at most
// that from the interval's axis, plus what the direction may turn away from it; and the angle from the axis is largest from a corner of the
// box, since a cone of less than a right angle is convex. So its depth is at least its distance times the cosine of that angle: not that of
// the image's corner, as for any direction. Both tests are monotone: a smaller box never sees more.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "render/view/enclosing_region.h"

namespace standin {

/// Where a small patch lies as seen from a box of eyes: the same for every gaze from it.
struct Bearing {
  /// `reach_m`: the patch lies within it of `point`.
  Bearing(const Vec3& point, double reach_m, const Box& eyes);
  Vec3 point;
  double reach_m;
  std::array<Vec3, 8> from_corners;  // unit directions; zero where a corner is the point
  double cos_reach = 1.0;            // of the angle over which the nearest eye may see the patch around its point; 0: a right angle or more
  double sin_reach = 0.0;
};

/// The views from a box of eyes in the interval of a cone. `cone` must outlive it.
class Gaze {
 public:
  Gaze(const DirectionCone& cone, const Box& eyes, const Camera& camera);
  /// Which planes of the enclosing frustum a sphere crosses, a bit each. nullopt: no view sees anything in it.
  [[nodiscard]] std::optional<std::uint32_t> planes_across(const Vec3& centre, double radius_m) const;
  /// Of all views that see a part of the patch: the least cosine of the angle at which they do. nullopt: no view sees it.
  /// `planes`: those that may cut it off.
  [[nodiscard]] std::optional<double> least_cosine(const Bearing& patch, std::uint32_t planes = ~0U) const;

 private:
  struct Side {
    Vec3 outward;
    double most = 0.0;  // dot(outward, p) of a point seen
  };
  const DirectionCone* cone_;
  std::vector<Side> sides_;     // at most 15: in front, six faces of boxes, eight of the roll-free camera
  double cos_corner_;           // of the image's half diagonal
  double cos_turn_, sin_turn_;  // of half the interval, corner to axis
};

}  // namespace standin
