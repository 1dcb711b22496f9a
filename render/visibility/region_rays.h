// Uniform rays from a region, and of which directions: the measure that a visible set's missed share is a share of.
//
// Positions are uniform over the box, directions over the sphere, or over a cone around all directions that can meet the scene where the
// region lies clear of it: whatever share of the cone's rays misses, of the sphere's it is less by the cone's share of the sphere.
#pragma once

#include "render/base/geometry.h"
#include "render/base/rng.h"

namespace standin {

/// Uniform over the box.
[[nodiscard]] Vec3 random_point(Rng& rng, const Box& box);

/// Directions that can lead from a region into the scene: all, or those of a cone.
class DirectionCap {
 public:
  DirectionCap(const Box& region, const Box& scene);

  /// 0..1
  [[nodiscard]] double share_of_sphere() const { return 0.5 * height_; }
  /// Uniform over the cap's solid angle (Archimedes).
  [[nodiscard]] Vec3 random_direction(Rng& rng) const;

 private:
  Vec3 axis_{0.0, 1.0, 0.0};
  Vec3 right_{1.0, 0.0, 0.0};
  Vec3 up_{0.0, 0.0, 1.0};
  double height_ = 2.0;  // 1 - cos of the half angle
};

}  // namespace standin
