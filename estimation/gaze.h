// Which points the views of a region may see, and how far from the middle of the image (thesis 5.5.2; math.md 4): the enclosing frustum of
// eyes in a box that look in an interval of directions, asked about the many surface samples of near objects, eight at a time.
//
// A sample is out where a plane of the enclosing frustum passes it. What is left is seen at an angle from the view's direction of at most
// that from the interval's axis, plus what the direction may turn away from it; and the angle from the axis is largest from a corner of the
// box, since a cone of less than a right angle is convex. So its depth is at least its distance times the cosine of that angle: not that of
// the image's corner, as for any direction. Both tests are monotone: a smaller box never sees more.
//
// All points are relative to the middle of the box, and rows hold the same of each sample, so that processors take some at once
// (render/base/vector_clones.h).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "render/view/enclosing_region.h"

namespace standin {

/// A number of each of so many samples.
inline constexpr std::size_t kLanes = 8;
using LaneRow = std::array<double, kLanes>;

/// Where up to kLanes small patches lie as seen from a box of eyes: the same for every gaze from it.
struct Bearings {
  /// All of the patch lies within `patch_reach_m` of `point` (world). To be followed by look_from().
  void set(std::size_t lane, const Vec3& point, double patch_reach_m, const Box& eyes);
  /// Once all lanes are set: what the other rows hold.
  void look_from(const Box& eyes);
  [[nodiscard]] Vec3 point(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }

  LaneRow x{}, y{}, z{};  // relative to the middle of the eyes
  LaneRow reach_m{};      // with what coordinates are rounded by
  std::array<LaneRow, 8> per_metre{};  // one over the distance from each corner of the box
  // Of the angle over which the nearest eye may see the patch around its point; 0 and 1: a right angle or more.
  LaneRow cos_reach{}, sin_reach{};
};

/// The views from a box of eyes in the interval of a cone.
class Gaze {
 public:
  Gaze(const DirectionCone& cone, const Box& eyes, const Camera& camera);
  /// Which planes of the enclosing frustum a sphere (its centre relative to the middle of the eyes) crosses, a bit each. nullopt: no view
  /// sees anything in it.
  [[nodiscard]] std::optional<std::uint32_t> planes_across(const Vec3& centre, double radius_m) const;
  /// Of all views that see a part of a patch: `least` cosine of the angle at which they do. 0: no view sees it.
  /// `planes`: those that may cut some of the patches off, a bit each; ~0U: any.
  void least_cosines(const Bearings& patches, std::uint32_t planes, LaneRow& least) const;

 private:
  /// Of the planes of the enclosing frustum, at most 15: in front, six faces of boxes, eight of the roll-free camera. Others pass nothing.
  struct Sides {
    std::array<double, 16> x{}, y{}, z{};  // outward
    std::array<double, 16> most{};         // dot(outward, p) of a point seen
  };
  Vec3 axis_;
  std::array<double, 8> corner_along_;  // of the box: dot(axis, corner)
  std::uint32_t all_sides_ = 0;         // a bit each
  Sides sides_;
  double cos_corner_;                   // of the image's half diagonal
  double cos_turn_, sin_turn_;          // of half the interval, corner to axis
};

}  // namespace standin
