#include "render/impostor/shift_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace standin {

ShiftBound::ShiftBound(const LayerSetup& setup, const ImpostorFrame& frame)
    : s_m_(setup.s),
      most_q_m_(setup.kind == LayerSetup::Kind::kBox ? setup.cell_depth : std::numeric_limits<double>::infinity()),
      slope_step_(frame.slope_step) {
  const Vec2 slope = setup.object_width / (2.0 * (setup.t0 + setup.s));
  a_m_ = slope * setup.s + 0.5 * setup.near_border;
  b_ = slope + (setup.kind == LayerSetup::Kind::kShaft ? setup.tan_half : Vec2(0.0));
}

Vec2 ShiftBound::texels(double depth_m, double layer_m) const {
  return {texels(0, depth_m, layer_m), texels(1, depth_m, layer_m)};
}

double ShiftBound::texels(int axis, double depth_m, double layer_m) const {
  const double d = depth_m - s_m_, layer = layer_m - s_m_, a = a_m_[axis], b = b_[axis];
  const auto f = [&](double q) { return (a + b * q) / ((layer + q) * (d + q)); };
  double most = f(0.0);
  if (std::isfinite(most_q_m_)) most = std::max(most, f(most_q_m_));
  const double inside = a * a - b * (a * (layer + d) - b * layer * d);
  if (b > 0.0 && inside > 0.0)
    if (const double q = (std::sqrt(inside) - a) / b; q > 0.0 && q < most_q_m_) most = std::max(most, f(q));
  return std::abs(layer_m - depth_m) * most / slope_step_[axis];
}

}  // namespace standin
