// The layer set-up (thesis 3.3.1, Eq. 3.1-3.6, in the strict form of math.md 1.3-1.6).
//
// Given a view cell, a box of objects and a texture resolution, place layers so that no point of the objects moves against its neighbour
// layer by more than one texel, and none is seen more than `alpha` away from its true direction, from anywhere in the view cell. One axis
// system for box and shaft: the reference viewpoint P is the origin, +y points to the objects, the near border of the view cell lies at y =
// s and t is the distance from that border (so A = t + s is the distance from P). We differ from the thesis: B is strict (all points of the
// frustum), deeper viewpoints bound the parallax too (F1), the depth border is clipped (F2), and the count is capped.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// Geometry of one layer set-up, lengths in metres. Throws Failure(kImpostorImpossible) from layer_distances where out of range.
struct LayerSetup {
  enum class Kind { kBox, kShaft } kind = Kind::kShaft;
  Vec2 near_border{0.0};    // n: full widths of the view cell's near border, >= 0
  double s = 0.0;           // height of the near border above P, >= 0
  double cell_depth = 0.0;  // m: box only, >= s
  Vec2 tan_half{0.0};       // T: shaft only
  Vec2 object_width{0.0};   // w: full widths of the object's frustum at its near face
  double t0 = 0.0;          // > 0: distance of the near face from the near border
  double depth = 0.0;       // of the object box; infinity allowed for boxes only
  Vec2 resolution{1.0};     // texels, >= 1
  double alpha_rad = 0.0;   // parallax limit, > 0
  bool strict = true;       // false: the thesis' own B and parallax range (for tests: it breaks its promise, F1)
};

enum class LayerBound : std::uint8_t { kNearBorder, kFarBorder, kShaft, kParallax, kEnd };

struct LayerDistance {
  double t = 0.0;  // all measured from the near border
  double near = 0.0;
  double far = 0.0;
  LayerBound bound = LayerBound::kEnd;  // what limited the step to the next layer
};

/// nullopt: more than `max_layers` are needed.
[[nodiscard]] std::optional<std::vector<LayerDistance>> layer_distances(const LayerSetup& setup, std::uint32_t max_layers);

/// O(1) estimate of the number of layers from the closed forms (math.md 1.4); may be off by a few, never for a set-up of one layer.
[[nodiscard]] double estimated_layer_count(const LayerSetup& setup);

// The formulas, exposed for golden vectors. All return +infinity where their denominator is not positive.
[[nodiscard]] double spacing_near(double t, double s, double w_slope, double tau, double n, bool strict);  // Eq. 3.2, 3.4
[[nodiscard]] double spacing_far(double t, double s, double w_slope, double tau, double n, double m);      // Eq. 3.3
[[nodiscard]] double spacing_shaft(double t, double s, double w_slope, double tau, double tan_half);       // Eq. 3.5
[[nodiscard]] double depth_border(double t_near, double c, double s);                                      // Eq. 3.6
[[nodiscard]] double parallax_behind(double t, double s, double r, double alpha_rad);                      // e_min
[[nodiscard]] double parallax_front(double t_far, double s, double r, double alpha_rad);

}  // namespace standin
