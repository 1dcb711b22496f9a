#include "estimation/gaze.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "render/base/error.h"
#include "render/base/vector_clones.h"

namespace standin {
namespace {

// Points that a view sees must not be lost to rounding: of coordinates, relatively, and of cosines. The cosines' is larger, since that of a
// near point comes from coordinates as large as the box of eyes.
constexpr double kRounding = 1e-12;
constexpr double kCosineRounding = 1e-11;
constexpr double kLeastDistance = 1e-100;  // no 0 / 0 where an eye is at the point

inline double sine(double cosine) {
  return std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
}

}  // namespace

void Bearings::set(std::size_t lane, const Vec3& world_point, double patch_reach_m, const Box& eyes) {
  const Vec3 point = world_point - eyes.centre();
  x[lane] = point.x, y[lane] = point.y, z[lane] = point.z;
  reach_m[lane] = patch_reach_m + kRounding * (std::abs(world_point.x) + std::abs(world_point.y) + std::abs(world_point.z));
}

STANDIN_VECTOR_CLONES void Bearings::look_from(const Box& eyes) {
  const Vec3 half = 0.5 * eyes.size();
  for (std::size_t corner = 0; corner < per_metre.size(); ++corner) {
    const Vec3 eye = eyes.corner(static_cast<int>(corner)) - eyes.centre();
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double dx = x[i] - eye.x, dy = y[i] - eye.y, dz = z[i] - eye.z;
      per_metre[corner][i] = 1.0 / std::max(std::sqrt(dx * dx + dy * dy + dz * dz), kLeastDistance);
    }
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double dx = std::max(0.0, std::abs(x[i]) - half.x), dy = std::max(0.0, std::abs(y[i]) - half.y),
                 dz = std::max(0.0, std::abs(z[i]) - half.z);
    const double nearest_m = std::max(std::sqrt(dx * dx + dy * dy + dz * dz), reach_m[i]);
    sin_reach[i] = reach_m[i] / std::max(nearest_m, kLeastDistance);
    cos_reach[i] = sine(sin_reach[i]);
  }
}

Gaze::Gaze(const DirectionCone& cone, const Box& eyes, const Camera& camera) : axis_(cone.axis) {
  const Vec3 centre = eyes.centre(), half_size = 0.5 * eyes.size();
  for (int i = 0; i < 8; ++i) corner_along_[static_cast<std::size_t>(i)] = glm::dot(axis_, eyes.corner(i) - centre);
  sides_.most.fill(std::numeric_limits<double>::infinity());
  std::size_t count = 0;
  if (cone.plane_normals.size() > sides_.most.size())
    throw Failure(ErrorWord::kInternal, "gaze: " + std::to_string(cone.plane_normals.size()) + " planes violate <= 16");
  for (const Vec3& normal : cone.plane_normals) {
    sides_.x[count] = normal.x, sides_.y[count] = normal.y, sides_.z[count] = normal.z;
    sides_.most[count++] = (1.0 + kRounding) * glm::dot(glm::abs(normal), half_size);
  }
  all_sides_ = (1U << count) - 1U;
  const double corner_rad = camera.half_diagonal_rad();
  const double turn_rad = std::max(0.0, cone.half_angle_rad - corner_rad);
  cos_corner_ = std::cos(corner_rad);
  cos_turn_ = std::cos(turn_rad), sin_turn_ = std::sin(turn_rad);
}

STANDIN_VECTOR_CLONES std::optional<std::uint32_t> Gaze::planes_across(const Vec3& centre, double radius_m) const {
  std::uint32_t across = 0;
  bool outside = false;
  for (std::size_t i = 0; i < sides_.most.size(); ++i) {
    const double beyond_m = sides_.x[i] * centre.x + sides_.y[i] * centre.y + sides_.z[i] * centre.z - sides_.most[i];
    outside |= beyond_m > radius_m;
    across |= static_cast<std::uint32_t>(beyond_m > -radius_m) << i;
  }
  return outside ? std::nullopt : std::optional(across);
}

STANDIN_VECTOR_CLONES void Gaze::least_cosines(const Bearings& patches, std::uint32_t planes, LaneRow& least) const {
  const auto& [x, y, z, reach_m, per_metre, cos_reach, sin_reach] = patches;
  LaneRow along, off, beyond_m;
  for (std::size_t i = 0; i < kLanes; ++i) along[i] = axis_.x * x[i] + axis_.y * y[i] + axis_.z * z[i];
  off.fill(1.0);  // cosine of the angle from the axis
  for (std::size_t k = 0; k < corner_along_.size(); ++k)
    for (std::size_t i = 0; i < kLanes; ++i) off[i] = std::min(off[i], (along[i] - corner_along_[k]) * per_metre[k][i]);
  beyond_m.fill(-std::numeric_limits<double>::infinity());
  for (std::uint32_t left = planes & all_sides_; left != 0; left &= left - 1) {
    const auto side = static_cast<std::size_t>(std::countr_zero(left));
    for (std::size_t i = 0; i < kLanes; ++i)
      beyond_m[i] = std::max(beyond_m[i], sides_.x[side] * x[i] + sides_.y[side] * y[i] + sides_.z[side] * z[i] - sides_.most[side]);
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double from_axis = off[i] - kCosineRounding;
    // Where an angle is a right one or more, so that a sum's cosine need not fall with it, it stays below the corner's all the same.
    const double far = from_axis * cos_reach[i] - sine(from_axis) * sin_reach[i];
    const double cosine = std::max(far * cos_turn_ - sine(far) * sin_turn_ - kRounding, cos_corner_);
    least[i] = beyond_m[i] > reach_m[i] ? 0.0 : cosine;
  }
}

}  // namespace standin
