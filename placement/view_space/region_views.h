// Single views of one region (3D cell x direction interval): drawn uniformly, or near another one, to climb towards the region's worst
// view.
//
// A region's bound is judged by the worst view found in it (thesis 5.5.2). In five dimensions, uniform views miss it by some percent
// however many are drawn; a climb from the worst of some comes nearer with fewer.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "placement/view_space/view_space.h"
#include "render/base/rng.h"
#include "render/view/camera.h"
#include "render/view/direction_interval.h"

namespace standin {

/// A position in the view space and the angles of a direction on an interval's face.
struct RegionPoint {
  Vec3 position{0.0};
  double a_rad = 0.0;
  double b_rad = 0.0;
};

class RegionViews {
 public:
  /// `parts`: of the view space inside the cell, not none (CellBoxes::parts).
  RegionViews(std::vector<Box> parts, const DirectionInterval& interval, Rng rng);

  /// Uniform over the parts and over the interval's angles.
  [[nodiscard]] RegionPoint draw();
  /// At most `share` (0..1) of the cell's size and of the interval's width away, in the same region.
  [[nodiscard]] RegionPoint draw_near(const RegionPoint& point, double share);
  [[nodiscard]] View view(const RegionPoint& point) const;

 private:
  [[nodiscard]] Vec3 position_near(const Vec3& position, double share);

  std::vector<Box> parts_;
  std::vector<double> volume_sums_;
  Vec3 size_m_;
  DirectionInterval interval_;
  Rng rng_;
};

/// `views` views of the region, of which the first half are drawn uniformly and the others climb from the worst: visit(view) returns how
/// bad a view is.
template <class Visit>
void climb_to_worst(RegionViews region, std::uint32_t views, Visit&& visit) {
  constexpr double kWidest = 0.5, kNarrowest = 0.01;
  const std::uint32_t uniform = (views + 1) / 2;
  RegionPoint worst;
  double worst_value = 0.0;
  for (std::uint32_t i = 0; i < views; ++i) {
    const double progress = i < uniform ? 0.0 : static_cast<double>(i - uniform) / static_cast<double>(views - uniform);
    const RegionPoint point = i < uniform ? region.draw() : region.draw_near(worst, kWidest * std::pow(kNarrowest / kWidest, progress));
    const double value = visit(region.view(point));
    if (i > 0 && value <= worst_value) continue;
    worst = point;
    worst_value = value;
  }
}

}  // namespace standin
