#include "placement/view_space/region_views.h"

#include <algorithm>

namespace standin {
namespace {

// Of an interval's width: a direction on its very border might be rounded into the next one.
constexpr double kBorder = 1e-9;

Vec3 size_of(const std::vector<Box>& parts) {
  Box all = parts.front();
  for (const Box& part : parts) all.extend(part);
  return all.size();
}

}  // namespace

RegionViews::RegionViews(std::vector<Box> parts, const DirectionInterval& interval, Rng rng)
    : parts_(std::move(parts)), volume_sums_(volume_sums(parts_)), size_m_(size_of(parts_)), interval_(interval), rng_(rng) {}

RegionPoint RegionViews::draw() {
  const auto [a0, a1, b0, b1] = interval_.angles_rad();
  const Vec3 position = sample_boxes(parts_, volume_sums_, rng_);
  const double a = rng_.uniform(a0, a1);
  return {position, a, rng_.uniform(b0, b1)};
}

RegionPoint RegionViews::draw_near(const RegionPoint& point, double share) {
  const auto [a0, a1, b0, b1] = interval_.angles_rad();
  const Vec3 position = position_near(point.position, share);
  const auto angle_near = [&](double angle, double least, double most) {
    const double reach = share * (most - least);
    const double border = kBorder * (most - least);
    return std::clamp(angle + rng_.uniform(-reach, reach), least + border, most - border);
  };
  const double a = angle_near(point.a_rad, a0, a1);
  return {position, a, angle_near(point.b_rad, b0, b1)};
}

// Where the step leaves the view space, it ends at the border of the part that it began in.
Vec3 RegionViews::position_near(const Vec3& position, double share) {
  Vec3 moved = position;
  for (int axis = 0; axis < 3; ++axis) moved[axis] += share * size_m_[axis] * rng_.uniform(-1.0, 1.0);
  const auto holds = [](const Vec3& point) { return [&point](const Box& part) { return part.contains(point); }; };
  if (std::ranges::any_of(parts_, holds(moved))) return moved;
  const auto own = std::ranges::find_if(parts_, holds(position));
  return own == parts_.end() ? position : glm::clamp(moved, own->min, own->max);
}

View RegionViews::view(const RegionPoint& point) const {
  return {point.position, direction_at(interval_.face, point.a_rad, point.b_rad)};
}

}  // namespace standin
