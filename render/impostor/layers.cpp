// Layer set-up in the frame of layers.h: the reference viewpoint P is the origin, +y points to the objects.
//
// One law carries the whole file. A point of slope u on a ray from P, seen from v = (vx, vy), moves between layers at A and A + c by c *
// kappa / (A - vy), where kappa = u vy - vx. One far texel is tau (A + c) wide, so the layers may be c = A tau / (sup|kappa| / (A - vy) -
// tau) apart, without limit where that denominator is not positive. Only sup|u| <= W enters, never the texture's symmetry: an object to
// one side of the axis is covered by W = its largest slope.
#include "render/impostor/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double quotient_or_infinity(double numerator, double denominator) {
  return denominator > 0.0 ? numerator / denominator : kInfinity;
}

/// K of math.md 1.5: how fast directions diverge at lateral distance r from the axis, at height s.
double divergence(double s, double r, double alpha_rad) {
  return r * std::cos(alpha_rad) + (std::hypot(r, s) - s * std::sin(alpha_rad));
}

void require(bool holds, const char* constraint, double value) {
  if (!holds)
    throw Failure(ErrorWord::kImpostorImpossible,
                  "layer set-up: " + std::string(constraint) + " does not hold for the value " + std::to_string(value));
}

void validate(const LayerSetup& setup) {
  const bool shaft = setup.kind == LayerSetup::Kind::kShaft;
  require(setup.t0 > 0.0 && std::isfinite(setup.t0), "0 < t0 < infinity", setup.t0);
  require(setup.s >= 0.0 && std::isfinite(setup.s), "0 <= s < infinity", setup.s);
  require(setup.alpha_rad > 0.0 && std::cos(setup.alpha_rad) > 0.0, "0 < alpha < 90 degrees", setup.alpha_rad);
  require(setup.depth >= 0.0, "depth >= 0", setup.depth);
  require(!shaft || std::isfinite(setup.depth), "a shaft needs a finite depth", setup.depth);
  require(setup.cell_depth >= 0.0 && std::isfinite(setup.cell_depth), "0 <= m < infinity", setup.cell_depth);
  for (int axis = 0; axis < 2; ++axis) {
    require(setup.near_border[axis] >= 0.0 && std::isfinite(setup.near_border[axis]), "0 <= n < infinity", setup.near_border[axis]);
    require(setup.object_width[axis] >= 0.0 && std::isfinite(setup.object_width[axis]), "0 <= w < infinity", setup.object_width[axis]);
    require(setup.resolution[axis] >= 1.0, "resolution >= 1", setup.resolution[axis]);
    require(!shaft || (setup.tan_half[axis] >= 0.0 && std::isfinite(setup.tan_half[axis])), "0 <= tan_half < infinity",
            setup.tan_half[axis]);
  }
}

/// A set-up with what follows from it, and the depth ranges and steps that hold at one layer.
class Spacing {
 public:
  explicit Spacing(const LayerSetup& setup) : setup_(setup) {
    const double near_face = setup.t0 + setup.s;
    half_slope_ = setup.object_width / (2.0 * near_face);
    texel_slope_ = 2.0 * half_slope_ / setup.resolution;
    corner_radius_ = 0.5 * std::hypot(setup.near_border.x, setup.near_border.y);
    slope_length_ = 2.0 * std::tan(0.5 * setup.alpha_rad);
    deep_slope_ = std::hypot(half_slope_.x, half_slope_.y);
    deep_offset_ = corner_radius_;
    deepest_ = setup.cell_depth - setup.s;
    if (setup.kind == LayerSetup::Kind::kShaft) {
      const double tan_half = std::hypot(setup.tan_half.x, setup.tan_half.y);
      deep_slope_ += tan_half;
      deep_offset_ += setup.s * tan_half;
      deepest_ = kInfinity;
    }
  }

  struct Step {
    double length = kInfinity;
    LayerBound bound = LayerBound::kEnd;
  };

  /// Longest step to the next layer that moves no point by more than one texel.
  [[nodiscard]] Step texel_step(double t) const {
    Step step;
    for (int axis = 0; axis < 2; ++axis) {
      const double w = half_slope_[axis], tau = texel_slope_[axis], n = setup_.near_border[axis];
      shorten(step, spacing_near(t, setup_.s, w, tau, n, setup_.strict), LayerBound::kNearBorder);
      if (setup_.kind == LayerSetup::Kind::kBox)
        shorten(step, spacing_far(t, setup_.s, w, tau, n, setup_.cell_depth), LayerBound::kFarBorder);
      else
        shorten(step, spacing_shaft(t, setup_.s, w, tau, setup_.tan_half[axis]), LayerBound::kShaft);
    }
    return step;
  }

  /// Depth behind a layer at t that stays within the parallax limit.
  [[nodiscard]] double behind(double t) const {
    const double near = parallax_behind(t, setup_.s, corner_radius_, setup_.alpha_rad);
    return setup_.strict ? std::min(near, deep_behind(t + setup_.s)) : near;
  }

  /// The same in front of a layer at t_far.
  [[nodiscard]] double in_front(double t_far) const {
    const double near = parallax_front(t_far, setup_.s, corner_radius_, setup_.alpha_rad);
    return setup_.strict ? std::min(near, deep_front(t_far + setup_.s)) : near;
  }

  [[nodiscard]] Vec2 half_slope() const { return half_slope_; }
  [[nodiscard]] Vec2 texel_slope() const { return texel_slope_; }
  [[nodiscard]] double corner_radius() const { return corner_radius_; }

  /// Ranges per metre that deeper viewpoints ask for at distance a from P: 1/L grows by slope_length / kappa with each.
  [[nodiscard]] double deep_density(double a) const {
    if (!setup_.strict || deepest_ < 0.0) return 0.0;
    const auto at = [&](double q) {
      const double kappa = deep_slope_ * q + deep_offset_, length = a + q;
      return kappa > slope_length_ * length ? kappa / (slope_length_ * length * length) : 0.0;
    };
    double densest = std::max(at(0.0), deepest_ < kInfinity ? at(deepest_) : 0.0);
    const double turning_point = deep_slope_ > 0.0 ? a - 2.0 * deep_offset_ / deep_slope_ : -1.0;
    if (turning_point > 0.0 && turning_point < deepest_) densest = std::max(densest, at(turning_point));
    return densest;
  }

  /// From here on one layer stands for everything, however deep; infinity for shafts wider than a texel.
  [[nodiscard]] double last_layer_at() const {
    double t = divergence(setup_.s, corner_radius_, setup_.alpha_rad) / (2.0 * std::sin(setup_.alpha_rad));
    if (!setup_.strict || deepest_ < 0.0) return t;
    if (deepest_ == kInfinity && deep_slope_ > slope_length_) return kInfinity;
    const double q = deepest_ < kInfinity ? deepest_ : 0.0;
    t = std::max(t, deep_offset_ / slope_length_ - setup_.s);
    return std::max(t, (deep_slope_ * q + deep_offset_) / slope_length_ - q - setup_.s);
  }

 private:
  static void shorten(Step& step, double length, LayerBound bound) {
    if (length < step.length) step = {length, bound};
  }

  /// Viewpoints at q = -vy >= 0 behind P see kappa(q) = U q + R; a piece of slope length 2 tan(alpha/2) never subtends more than alpha.
  [[nodiscard]] double deep_behind(double a) const {
    const auto range = [&](double q) {
      const double reach = slope_length_ * (a + q);
      return quotient_or_infinity(reach * (a + q), deep_slope_ * q + deep_offset_ - reach);
    };
    const double u = deep_slope_, turning = ((u + slope_length_) * a - 2.0 * deep_offset_) / (u - slope_length_);
    return least_over_depths(range, u > slope_length_ ? turning : -1.0);
  }

  [[nodiscard]] double deep_front(double a) const {
    const auto range = [&](double q) {
      const double reach = slope_length_ * (a + q);
      return reach * (a + q) / (deep_slope_ * q + deep_offset_ + reach);
    };
    return least_over_depths(range, ((deep_slope_ - slope_length_) * a - 2.0 * deep_offset_) / (deep_slope_ + slope_length_));
  }

  /// Least of range(q) over q in [0, deepest]: at the ends or where its derivative vanishes.
  template <class Range>
  [[nodiscard]] double least_over_depths(const Range& range, double turning_point) const {
    if (deepest_ < 0.0) return kInfinity;
    double least = range(0.0);
    if (deepest_ < kInfinity) least = std::min(least, range(deepest_));
    if (turning_point > 0.0 && turning_point < deepest_) least = std::min(least, range(turning_point));
    return least;
  }

  const LayerSetup& setup_;
  Vec2 half_slope_{0.0};        // W
  Vec2 texel_slope_{0.0};       // tau
  double corner_radius_ = 0.0;  // r: half the diagonal of the near border
  double slope_length_ = 0.0;   // what subtends at most alpha from anywhere
  double deep_slope_ = 0.0;     // U
  double deep_offset_ = 0.0;    // R
  double deepest_ = 0.0;        // largest q, negative: the cell ends in front of P
};

/// The recursion c = k t (t + s) / (b - k t), which multiplies 1 + s/t by b / (b + k s) at each step: layers per metre, such that their
/// integral between two layers is the number of steps exactly (math.md 1.4).
class MoebiusSteps {
 public:
  MoebiusSteps() = default;
  MoebiusSteps(double s, double b, double k) : s_(s), b_(b), k_(k) {
    const double x = b > 0.0 ? k * s / b : 0.0;
    scale_ = k > 0.0 ? b / k * (x > -1.0 && x != 0.0 ? x / std::log1p(x) : 1.0) : 0.0;
  }
  [[nodiscard]] double per_metre(double t) const { return b_ - k_ * t > 0.0 ? scale_ / (t * (t + s_)) : 0.0; }

 private:
  double s_ = 0.0, b_ = 0.0, k_ = 0.0, scale_ = 0.0;
};

/// Layers per metre at any distance: the densest of all bounds.
class LayerDensity {
 public:
  LayerDensity(const LayerSetup& setup, const Spacing& spacing) : setup_(setup), spacing_(spacing) {
    parallax_ = MoebiusSteps(setup.s, divergence(setup.s, spacing.corner_radius(), setup.alpha_rad), 2.0 * std::sin(setup.alpha_rad));
    for (int axis = 0; axis < 2; ++axis) {
      const double w = spacing.half_slope()[axis], tau = spacing.texel_slope()[axis], half_n = 0.5 * setup.near_border[axis];
      const auto i = static_cast<std::size_t>(axis);
      near_[i] = MoebiusSteps(setup.s, half_n + (setup.strict ? w : w - tau) * setup.s, tau);
      if (setup.kind == LayerSetup::Kind::kBox)
        far_[i] = MoebiusSteps(setup.s - setup.cell_depth, half_n + w * std::max(0.0, setup.cell_depth - setup.s), tau);
      else if (w + setup.tan_half[axis] > tau)
        shaft_ = std::max(shaft_, -1.0 / std::log1p(-tau / (w + setup.tan_half[axis])));
    }
  }

  [[nodiscard]] double per_metre(double t) const {
    const double a = t + setup_.s, t_far = t + setup_.cell_depth;
    // A layer reaches one parallax range behind itself, and the next one's range in front of that.
    const double parallax = 0.5 * std::max(parallax_.per_metre(t), spacing_.deep_density(a));
    const double texel = std::max(near_[0].per_metre(t), near_[1].per_metre(t));
    return std::max({parallax, texel, shaft_ / a, far_[0].per_metre(t_far), far_[1].per_metre(t_far)});
  }

 private:
  const LayerSetup& setup_;
  const Spacing& spacing_;
  MoebiusSteps parallax_;
  std::array<MoebiusSteps, 2> near_, far_;
  double shaft_ = 0.0;  // layers per e-fold of the distance from P
};

/// The step that follows a layer at t: texel limit, parallax limit, and never beyond the object.
Spacing::Step next_step(const Spacing& spacing, const LayerSetup& setup, double t, double behind, double t_end) {
  const double reach = t + behind;
  Spacing::Step step = spacing.texel_step(t);
  const double parallax = behind + spacing.behind(reach);
  if (parallax < step.length) step = {parallax, LayerBound::kParallax};
  if (t_end - t < step.length) step = {t_end - t, LayerBound::kEnd};
  if (step.length == kInfinity) step = {behind + depth_border(reach, kInfinity, setup.s), LayerBound::kParallax};
  return step;
}

/// Where the range of a layer at t ends and that of the next one, a step behind, begins. In the strict form the border of equation 3.6
/// yields to the parallax limits of both layers: along a diagonal it would break them (F2).
double border_between(const Spacing& spacing, const LayerSetup& setup, double t, double behind, double step) {
  const double border = t + depth_border(t, step, setup.s);
  if (!setup.strict) return border;
  const double t_next = t + step;
  return std::min(std::max(border, t_next - spacing.in_front(t_next)), t + behind);
}

}  // namespace

double spacing_near(double t, double s, double w_slope, double tau, double n, bool strict) {
  const double b = 0.5 * n + (s >= 0.0 ? (strict ? w_slope : w_slope - tau) * s : -w_slope * s);
  return quotient_or_infinity(tau * t * (t + s), b - tau * t);
}

double spacing_far(double t, double s, double w_slope, double tau, double n, double m) {
  const double q = m - s;  // < 0: the far border lies in front of P and never binds
  const double b = 0.5 * n + (q >= 0.0 ? w_slope * q : (tau - w_slope) * q);
  return quotient_or_infinity(tau * (t + s) * (t + m), b - tau * (t + m));
}

double spacing_shaft(double t, double s, double w_slope, double tau, double tan_half) {
  return quotient_or_infinity(tau * (t + s), w_slope + tan_half - tau);
}

double depth_border(double t_near, double c, double s) {
  if (c == kInfinity) return t_near * std::sqrt(1.0 + s / t_near);
  const double t_far = t_near + c;
  return c / (1.0 + std::sqrt((t_far / t_near) * ((t_far + s) / (t_near + s))));
}

double parallax_behind(double t, double s, double r, double alpha_rad) {
  const double k = 2.0 * std::sin(alpha_rad);
  return quotient_or_infinity(k * t * (t + s), divergence(s, r, alpha_rad) - k * t);
}

double parallax_front(double t_far, double s, double r, double alpha_rad) {
  if (t_far == kInfinity) return kInfinity;
  const double k = 2.0 * std::sin(alpha_rad);
  return k * t_far * (t_far + s) / (divergence(s, r, alpha_rad) + k * (t_far + s));
}

std::optional<std::vector<LayerDistance>> layer_distances(const LayerSetup& setup, std::uint32_t max_layers) {
  validate(setup);
  const Spacing spacing(setup);
  const double t_end = setup.t0 + setup.depth;
  std::vector<LayerDistance> layers;
  if (max_layers == 0) return std::nullopt;
  const double first_range = spacing.behind(setup.t0);
  if (setup.t0 + first_range >= t_end) {
    layers.push_back({setup.t0 + depth_border(setup.t0, setup.depth, setup.s), setup.t0, t_end, LayerBound::kEnd});
    return layers;
  }
  // A point and its image differ by the same angle whichever of the two is in front, so the first layer lies one range behind the near
  // face.
  double t = setup.t0 + first_range, near = setup.t0;
  while (layers.size() < max_layers) {
    const double behind = spacing.behind(t);
    if (t + behind >= t_end) {
      layers.push_back({t, near, t_end, LayerBound::kEnd});
      return layers;
    }
    const Spacing::Step step = next_step(spacing, setup, t, behind, t_end);
    const double border = border_between(spacing, setup, t, behind, step.length);
    layers.push_back({t, near, border, step.bound});
    if (!(t + step.length > t)) return std::nullopt;  // below the resolution of a double: no number of layers is enough
    near = border;
    t += step.length;
  }
  return std::nullopt;
}

double estimated_layer_count(const LayerSetup& setup) {
  validate(setup);
  const Spacing spacing(setup);
  const double t_end = setup.t0 + setup.depth;
  const double t_first = setup.t0 + spacing.behind(setup.t0);
  if (t_first >= t_end || t_first + spacing.behind(t_first) >= t_end) return 1.0;
  double t_last = std::min(t_end, spacing.last_layer_at());
  if (t_last < kInfinity) t_last = std::min(t_last, t_end < kInfinity ? t_end - spacing.in_front(t_end) : t_last);
  if (t_last == kInfinity) return kInfinity;
  if (t_last <= t_first) return 2.0;
  // Three-point Gauss-Legendre on panels of equal ratio: the densities are smooth in log t, with a kink where the binding bound changes.
  constexpr int kPanels = 8;
  constexpr double kNode = 0.77459666924148337704, kWeights[] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double panel = std::log(t_last / t_first) / kPanels;
  const double ratio = std::exp(panel), node_ratio = std::exp(0.5 * kNode * panel);
  const LayerDensity density(setup, spacing);
  double sum = 0.0, middle = t_first * std::sqrt(ratio);
  for (int i = 0; i < kPanels; ++i, middle *= ratio) {
    const double nodes[] = {middle / node_ratio, middle, middle * node_ratio};
    for (int j = 0; j < 3; ++j) sum += kWeights[j] * panel * nodes[j] * density.per_metre(nodes[j]);
  }
  return 1.0 + std::ceil(sum);
}

}  // namespace standin
