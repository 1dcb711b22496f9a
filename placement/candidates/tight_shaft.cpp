#include "placement/candidates/tight_shaft.h"

#include <cmath>
#include <limits>

namespace standin {
namespace {

constexpr double kSpare = 1e-9;
constexpr int kAimingRounds = 3;  // turning the frame about one axis moves slopes along the other a little

/// Slopes and distances of all corners in a shaft's frame.
struct Span {
  Vec2 slope_min{std::numeric_limits<double>::infinity()};
  Vec2 slope_max{-std::numeric_limits<double>::infinity()};
  double near_m = std::numeric_limits<double>::infinity();
};

Span span_of(const Shaft& frame, std::span<const Box> cells) {
  Span span;
  for (const Box& cell : cells) {
    for (int i = 0; i < 8; ++i) {
      const Vec3 from_apex = cell.corner(i) - frame.apex;
      const double along_m = glm::dot(from_apex, frame.axis);
      span.near_m = std::min(span.near_m, along_m);
      if (along_m <= 0.0) return span;
      const Vec2 slope = Vec2(glm::dot(from_apex, frame.right), glm::dot(from_apex, frame.up)) / along_m;
      span.slope_min = glm::min(span.slope_min, slope);
      span.slope_max = glm::max(span.slope_max, slope);
    }
  }
  return span;
}

std::optional<Vec3> mean_direction(const Vec3& apex, std::span<const Box> cells) {
  Vec3 sum(0.0);
  for (const Box& cell : cells) {
    const Vec3 from_apex = cell.centre() - apex;
    const double distance_m = glm::length(from_apex);
    if (distance_m <= 0.0) return std::nullopt;
    sum += from_apex / distance_m;
  }
  const double length = glm::length(sum);
  if (length <= 1e-6) return std::nullopt;
  return sum / length;
}

}  // namespace

std::optional<Shaft> tight_shaft(const Vec3& apex, std::span<const Box> cells) {
  const auto direction = mean_direction(apex, cells);
  if (!direction) return std::nullopt;
  Shaft shaft = shaft_frame(apex, *direction);
  Span span = span_of(shaft, cells);
  for (int round = 0; round < kAimingRounds && span.near_m > 0.0; ++round) {
    const Vec2 middle = glm::tan(0.5 * (glm::atan(span.slope_min) + glm::atan(span.slope_max)));
    const Shaft aimed = shaft_frame(apex, glm::normalize(shaft.axis + middle.x * shaft.right + middle.y * shaft.up));
    const Span aimed_span = span_of(aimed, cells);
    if (aimed_span.near_m <= 0.0) break;  // a corner fell behind: the present aim is the better one
    shaft = aimed;
    span = aimed_span;
  }
  if (span.near_m <= 0.0) return std::nullopt;
  shaft.tan_half = glm::max(glm::abs(span.slope_min), glm::abs(span.slope_max)) * (1.0 + kSpare);
  shaft.min_distance_m = span.near_m * (1.0 - kSpare);
  return shaft;
}

}  // namespace standin
