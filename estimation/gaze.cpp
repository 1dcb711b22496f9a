#include "estimation/gaze.h"

#include <algorithm>
#include <bit>

namespace standin {
namespace {

namespace stdx = std::experimental;

// Points that a view sees must not be lost to rounding: of coordinates, relatively, and of cosines. The cosines' is larger, since that of a
// near point comes from coordinates as large as the box of eyes.
constexpr double kRounding = 1e-12;
constexpr double kCosineRounding = 1e-11;

double sine(double cosine) {
  return std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
}

Lanes sine(const Lanes& cosine) {
  return stdx::sqrt(stdx::max(Lanes(0.0), 1.0 - cosine * cosine));
}

}  // namespace

void Bearings::set(std::size_t lane, const Vec3& world_point, double patch_reach_m, const Box& eyes) {
  const Vec3 point = world_point - eyes.centre();
  x[lane] = point.x, y[lane] = point.y, z[lane] = point.z;
  for (int i = 0; i < 8; ++i) {
    const double distance_m = glm::length(world_point - eyes.corner(i));
    per_metre[static_cast<std::size_t>(i)][lane] = distance_m > 0.0 ? 1.0 / distance_m : 0.0;
  }
  const double sin_of_reach =
      patch_reach_m > 0.0 ? std::min(1.0, patch_reach_m / std::max(distance(world_point, eyes), patch_reach_m)) : 0.0;
  sin_reach[lane] = sin_of_reach;
  cos_reach[lane] = sine(sin_of_reach);
  reach_m[lane] = patch_reach_m + kRounding * (std::abs(world_point.x) + std::abs(world_point.y) + std::abs(world_point.z));
}

Gaze::Gaze(const DirectionCone& cone, const Box& eyes, const Camera& camera) : axis_(cone.axis) {
  const Vec3 centre = eyes.centre(), half_size = 0.5 * eyes.size();
  for (int i = 0; i < 8; ++i) corner_along_[static_cast<std::size_t>(i)] = glm::dot(axis_, eyes.corner(i) - centre);
  for (const Vec3& normal : cone.plane_normals) sides_.push_back({normal, (1.0 + kRounding) * glm::dot(glm::abs(normal), half_size)});
  all_sides_ = (1U << sides_.size()) - 1U;
  const double corner_rad = camera.half_diagonal_rad();
  const double turn_rad = std::max(0.0, cone.half_angle_rad - corner_rad);
  cos_corner_ = std::cos(corner_rad);
  cos_turn_ = std::cos(turn_rad), sin_turn_ = std::sin(turn_rad);
}

std::optional<std::uint32_t> Gaze::planes_across(const Vec3& centre, double radius_m) const {
  std::uint32_t across = 0;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double beyond_m = glm::dot(sides_[i].outward, centre) - sides_[i].most;
    if (beyond_m > radius_m) return std::nullopt;
    if (beyond_m > -radius_m) across |= 1U << i;
  }
  return across;
}

LaneRow Gaze::least_cosines(const Bearings& patches, std::uint32_t planes) const {
  LaneRow least;
  for (std::size_t lane = 0; lane < kLanes; lane += Lanes::size()) {
    const Lanes x = lanes_at(patches.x, lane), y = lanes_at(patches.y, lane), z = lanes_at(patches.z, lane);
    const Lanes reach_m = lanes_at(patches.reach_m, lane);
    Lanes::mask_type out(false);
    for (std::uint32_t left = planes & all_sides_; left != 0; left &= left - 1) {
      const Side& side = sides_[static_cast<std::size_t>(std::countr_zero(left))];
      out = out || side.outward.x * x + side.outward.y * y + side.outward.z * z > side.most + reach_m;
    }
    const Lanes along = axis_.x * x + axis_.y * y + axis_.z * z;
    Lanes off(1.0);  // cosine of the angle from the axis
    for (std::size_t k = 0; k < corner_along_.size(); ++k)
      off = stdx::min(off, (along - corner_along_[k]) * lanes_at(patches.per_metre[k], lane));
    off -= kCosineRounding;
    // Where an angle is a right one or more, so that a sum's cosine need not fall with it, it stays below the corner's all the same.
    const Lanes far = off * lanes_at(patches.cos_reach, lane) - sine(off) * lanes_at(patches.sin_reach, lane);
    Lanes cosine = stdx::max(far * cos_turn_ - sine(far) * sin_turn_ - kRounding, Lanes(cos_corner_));
    stdx::where(out, cosine) = 0.0;
    cosine.copy_to(&least[lane], stdx::element_aligned);
  }
  return least;
}

}  // namespace standin
