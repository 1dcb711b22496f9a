// How far a point beside its layer's plane may seem from its texel, from anywhere in the view cell (math.md 1.2).
//
// Layers one texel apart keep a surface connected (thesis 3.3). They do not keep the rims of two surfaces together that happen to meet in
// some view: each may shift by up to a texel, one to the left, the other to the right, and what lies behind shows through between them. So
// a rim must cover the texels on its layer that any ray through it may pass (recorder.h). Point at depth d, plane at depth D, both from the
// reference viewpoint; viewpoint q behind the near border, which lies s before the reference viewpoint: in texels of slope tau the shift is
// at most
//
//     |D - d| f(q) / tau,   f(q) = (a + b q) / ((D - s + q) (d - s + q)),   a = U s + n / 2,   b = U + T    (box: T = 0, q <= m)
//
// per axis, where U is the greatest slope. f has one maximum over q >= 0, where b q^2 + 2 a q + a (D' + d') - b D' d' = 0.
#pragma once

#include "render/impostor/impostor.h"
#include "render/impostor/layers.h"

namespace standin {

class ShiftBound {
 public:
  ShiftBound(const LayerSetup& setup, const ImpostorFrame& frame);

  /// Texels along x and y, >= 0. Both depths lie beyond the near border.
  [[nodiscard]] Vec2 texels(double depth_m, double layer_m) const;

 private:
  [[nodiscard]] double texels(int axis, double depth_m, double layer_m) const;

  double s_m_;
  double most_q_m_;  // infinity for shafts
  Vec2 a_m_{0.0};
  Vec2 b_{0.0};
  Vec2 slope_step_{0.0};
};

}  // namespace standin
