#include "estimation/gaze.h"

#include <algorithm>

namespace standin {
namespace {

// Points that a view sees must not be lost to rounding: of the coordinates, and of the cosines.
constexpr double kRounding = 1e-12;

}  // namespace

Bearing::Bearing(const Vec3& patch_point, double patch_reach_m, const Box& eyes) : point(patch_point), reach_m(patch_reach_m) {
  for (int i = 0; i < 8; ++i) {
    const Vec3 line = point - eyes.corner(i);
    const double length_m = glm::length(line);
    from_corners[static_cast<std::size_t>(i)] = length_m > 0.0 ? line / length_m : Vec3(0.0);
  }
  if (reach_m <= 0.0) return;
  sin_reach = std::min(1.0, reach_m / std::max(distance(point, eyes), reach_m));
  cos_reach = std::sqrt(1.0 - sin_reach * sin_reach);
}

Gaze::Gaze(const DirectionCone& cone, const Box& eyes, const Camera& camera) : cone_(&cone) {
  const Vec3 reach = glm::max(glm::abs(eyes.min), glm::abs(eyes.max));
  for (const Vec3& normal : cone.plane_normals)
    sides_.push_back({normal, eyes.support(normal) + kRounding * (reach.x + reach.y + reach.z)});
  const double corner_rad = camera.half_diagonal_rad();
  const double turn_rad = std::max(0.0, cone.half_angle_rad - corner_rad);
  cos_corner_ = std::cos(corner_rad);
  cos_turn_ = std::cos(turn_rad), sin_turn_ = std::sin(turn_rad);
}

bool Gaze::may_see(const Vec3& point, double reach_m) const {
  const double slack_m = reach_m + kRounding * (std::abs(point.x) + std::abs(point.y) + std::abs(point.z) + reach_m);
  return std::ranges::all_of(sides_, [&](const Side& side) { return glm::dot(side.outward, point) <= side.most + slack_m; });
}

std::optional<double> Gaze::least_cosine(const Bearing& patch) const {
  if (!may_see(patch.point, patch.reach_m)) return std::nullopt;
  double cos_off = 1.0;  // from the axis
  for (const Vec3& line : patch.from_corners) {
    cos_off = std::min(cos_off, glm::dot(line, cone_->axis));
    if (cos_off <= cos_corner_) return cos_corner_;
  }
  const double sin_off = std::sqrt(1.0 - cos_off * cos_off);
  // Both angles are less than a right one, so the sum's cosine falls with it; the same for the turn.
  const double cos_far = cos_off * patch.cos_reach - sin_off * patch.sin_reach;
  if (cos_far <= cos_corner_) return cos_corner_;
  const double sin_far = std::sqrt(1.0 - cos_far * cos_far);
  return std::max(cos_corner_, cos_far * cos_turn_ - sin_far * sin_turn_ - kRounding);
}

}  // namespace standin
