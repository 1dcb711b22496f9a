#include "render/visibility/region_rays.h"

#include <cmath>
#include <numbers>

namespace standin {

Vec3 random_point(Rng& rng, const Box& box) {
  const double x = rng.uniform();
  const double y = rng.uniform();
  const double z = rng.uniform();
  return box.min + Vec3(x, y, z) * box.size();
}

DirectionCap::DirectionCap(const Box& region, const Box& scene) {
  const Vec3 way = scene.centre() - region.centre();
  const double distance_m = glm::length(way);
  const double reach_m = 0.5 * (region.diagonal() + scene.diagonal()) * (1.0 + 1e-9);
  if (reach_m >= distance_m) return;
  axis_ = way / distance_m;
  right_ = glm::normalize(glm::cross(axis_, std::abs(axis_.y) < 0.9 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0)));
  up_ = glm::cross(right_, axis_);
  height_ = 1.0 - std::sqrt(1.0 - (reach_m / distance_m) * (reach_m / distance_m));
}

Vec3 DirectionCap::random_direction(Rng& rng) const {
  const double along = 1.0 - height_ * rng.uniform();
  const double turn = 2.0 * std::numbers::pi * rng.uniform();
  const double radius = std::sqrt(std::max(0.0, 1.0 - along * along));
  return along * axis_ + radius * (std::cos(turn) * right_ + std::sin(turn) * up_);
}

}  // namespace standin
