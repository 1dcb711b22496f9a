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

std::optional<std::uint32_t> Gaze::planes_across(const Vec3& centre, double radius_m) const {
  const double reach_m = radius_m + kRounding * (std::abs(centre.x) + std::abs(centre.y) + std::abs(centre.z) + radius_m);
  std::uint32_t across = 0;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double beyond_m = glm::dot(sides_[i].outward, centre) - sides_[i].most;
    if (beyond_m > reach_m) return std::nullopt;
    if (beyond_m > -reach_m) across |= 1U << i;
  }
  return across;
}

std::optional<double> Gaze::least_cosine(const Bearing& patch, std::uint32_t planes) const {
  const double reach_m = patch.reach_m + kRounding * (std::abs(patch.point.x) + std::abs(patch.point.y) + std::abs(patch.point.z));
  for (std::size_t i = 0; i < sides_.size() && (planes >> i) != 0; ++i)
    if ((planes >> i & 1U) != 0 && glm::dot(sides_[i].outward, patch.point) > sides_[i].most + reach_m) return std::nullopt;
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
