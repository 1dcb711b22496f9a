#include "render/view/enclosing_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace standin {
namespace {

// Added to every opening angle: rounding of points and normals (1e-15) can then not push a seen point out.
constexpr double kAngleSlackRad = 1e-9;
// A half angle nearer than this to a right angle bounds nothing worth testing.
constexpr double kFlatRad = 0.5 * std::numbers::pi - 1e-6;
// Steps of the grid of sampled directions, per side of the interval: about a third of a degree each.
constexpr double kGridStepRad = 0.006;
constexpr int kLeastGridSteps = 8;
constexpr int kMostGridSteps = 48;
// Closer to the poles than this cosine of the elevation, the roll-free camera turns too fast for sampled planes.
constexpr double kLeastCosElevation = 0.05;
constexpr int kPlaneDirections = 8;

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Vec3 cell_direction(const FaceFrame& frame, double tan_a, double tan_b) {
  return glm::normalize(frame.n + tan_a * frame.u + tan_b * frame.v);
}

// A: the smallest cap about the mean corner that holds the interval, widened by the half diagonal of the image. A cap below 90 degrees is
// convex, so the corners suffice.
DirectionCone any_roll_cone(const FaceFrame& frame, const std::array<double, 4>& tangents, double tan_half_x, double tan_half_y) {
  const auto [a0, a1, b0, b1] = tangents;
  const std::array<Vec3, 4> corners = {cell_direction(frame, a0, b0), cell_direction(frame, a1, b0), cell_direction(frame, a1, b1),
                                       cell_direction(frame, a0, b1)};
  DirectionCone cone;
  cone.axis = glm::normalize(corners[0] + corners[1] + corners[2] + corners[3]);
  for (const Vec3& corner : corners) cone.half_angle_rad = std::max(cone.half_angle_rad, angle_between(cone.axis, corner));
  cone.half_angle_rad += std::atan(std::hypot(tan_half_x, tan_half_y)) + kAngleSlackRad;
  return cone;
}

// Corner rays of the frusta of a grid of directions, and how far (as a rotation) any frustum of the interval is from one of them.
struct SampledFrusta {
  std::vector<Vec3> corner_rays;
  double reach_rad = 0.0;
};

int grid_steps(double low_rad, double high_rad) {
  return std::clamp(static_cast<int>(std::ceil((high_rad - low_rad) / kGridStepRad)), kLeastGridSteps, kMostGridSteps);
}

std::vector<double> grid_tangents(double low_rad, double high_rad, int steps) {
  std::vector<double> tangents;
  for (int i = 0; i <= steps; ++i) tangents.push_back(std::tan(low_rad + (high_rad - low_rad) * i / steps));
  return tangents;
}

// nullopt near the poles. Every direction is within half a grid step in each of the two angles of a sample; on a cube face (tangents in
// [-1, 1]) a change of one angle turns the direction by no more than that, so by at most `turn`. Turning a direction changes the elevation
// by no more, and the azimuth by no more than 1 / cos(elevation) times that; and two roll-free cameras differ by a rotation of at most the
// sum of the changes in azimuth and elevation.
std::optional<SampledFrusta> sample_frusta(const FaceFrame& frame, const std::array<double, 4>& tangents, double tan_half_x,
                                           double tan_half_y, const Vec3& up) {
  std::array<double, 4> angles{};
  std::transform(tangents.begin(), tangents.end(), angles.begin(), [](double tangent) { return std::atan(tangent); });
  const auto [a0, a1, b0, b1] = angles;
  const int steps = std::max(grid_steps(a0, a1), grid_steps(b0, b1));
  const double turn = 0.5 * (a1 - a0 + b1 - b0) / steps;
  SampledFrusta result;
  double least_cos = 1.0;
  for (const double tan_a : grid_tangents(a0, a1, steps))
    for (const double tan_b : grid_tangents(b0, b1, steps)) {
      const Vec3 direction = cell_direction(frame, tan_a, tan_b);
      const Vec3 across = glm::cross(direction, up);
      const double cos_elevation = glm::length(across);
      if (cos_elevation - turn < kLeastCosElevation) return std::nullopt;
      least_cos = std::min(least_cos, cos_elevation - turn);
      const Vec3 x = tan_half_x / cos_elevation * across;
      const Vec3 y = tan_half_y / cos_elevation * glm::cross(across, direction);
      for (const Vec3& ray : {direction + x + y, direction + x - y, direction - x + y, direction - x - y})
        result.corner_rays.push_back(glm::normalize(ray));
    }
  result.reach_rad = turn * (1.0 + 1.0 / least_cos) + kAngleSlackRad;
  return result;
}

// The least angle from `axis` towards `lateral` such that the plane through the apex at that angle has all frusta on one side. A ray within
// `reach` of a sample differs from it in that angle by at most asin(sin(reach) / length of its projection). nullopt: none below 90 degrees.
std::optional<double> plane_angle(const SampledFrusta& frusta, const Vec3& axis, const Vec3& lateral) {
  const double sin_reach = std::sin(frusta.reach_rad);
  double least_along = 1.0;
  for (const Vec3& ray : frusta.corner_rays) least_along = std::min(least_along, glm::dot(ray, axis));
  if (least_along <= sin_reach) return std::nullopt;
  const double most_reach_rad = std::asin(sin_reach / least_along);
  double widest = -kFlatRad;
  double least_tangent = -std::numeric_limits<double>::infinity();  // of rays that could still widen it: spares most arc functions
  for (const Vec3& ray : frusta.corner_rays) {
    const double along = glm::dot(ray, axis);
    const double across = glm::dot(ray, lateral);
    if (across < along * least_tangent) continue;
    widest = std::max(widest, std::atan2(across, along) + std::asin(sin_reach / std::hypot(along, across)));
    least_tangent = std::tan(std::max(widest - most_reach_rad, -kFlatRad));
  }
  if (widest >= kFlatRad) return std::nullopt;
  return widest;
}

// C: planes tilted from the axis towards eight lateral directions. Elsewhere than on the poles the camera's own right and up are among
// them, where the rectangular image makes them tightest.
void add_roll_free_planes(DirectionCone& cone, const SampledFrusta& frusta, const Vec3& up) {
  const Vec3 right = glm::normalize(glm::cross(cone.axis, up));
  const Vec3 above = glm::cross(right, cone.axis);
  for (int k = 0; k < kPlaneDirections; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / kPlaneDirections;
    const Vec3 lateral = std::cos(turn) * right + std::sin(turn) * above;
    if (const auto angle = plane_angle(frusta, cone.axis, lateral))
      cone.plane_normals.push_back(std::cos(*angle) * lateral - std::sin(*angle) * cone.axis);
  }
}

// The half-space in front, first since it rejects most. A long box can lie wholly behind the viewer and yet cut every tilted plane: where
// the cone keeps to one side of a plane parallel to the faces of boxes, that plane is a border too.
void add_front_planes(DirectionCone& cone) {
  if (cone.half_angle_rad >= kFlatRad) return;
  cone.plane_normals.push_back(-cone.axis);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Vec3 inward(0.0);
      inward[axis] = sign;
      if (angle_between(cone.axis, inward) + cone.half_angle_rad < kFlatRad) cone.plane_normals.push_back(-inward);
    }
}

// Least dot(normal, x) over the box [low, high].
double least_of(const Vec3& normal, const Vec3& low, const Vec3& high) {
  return std::min(normal.x * low.x, normal.x * high.x) + std::min(normal.y * low.y, normal.y * high.y) +
         std::min(normal.z * low.z, normal.z * high.z);
}

}  // namespace

DirectionCone enclosing_cone(const FaceFrame& frame, const std::array<double, 4>& tangents, double tan_half_x, double tan_half_y,
                             const Vec3& up) {
  DirectionCone cone = any_roll_cone(frame, tangents, tan_half_x, tan_half_y);
  add_front_planes(cone);
  if (const auto frusta = sample_frusta(frame, tangents, tan_half_x, tan_half_y, up)) add_roll_free_planes(cone, *frusta, up);
  cone.cos_half_angle = std::cos(cone.half_angle_rad);
  cone.sin_half_angle = std::sin(cone.half_angle_rad);
  return cone;
}

DirectionCone enclosing_cone(const DirectionInterval& interval, const Camera& camera) {
  std::array<double, 4> tangents = interval.angles_rad();
  for (double& angle : tangents) angle = std::tan(angle);
  return enclosing_cone(face_frame(interval.face), tangents, camera.tan_half_x(), camera.tan_half_y(), {0.0, 1.0, 0.0});
}

bool may_see(const DirectionCone& cone, const Box& positions, const Box& box) {
  // All differences "point of the box minus position" form a box again: the question is whether it misses a cone whose apex is the origin.
  const Vec3 low = box.min - positions.max;
  const Vec3 high = box.max - positions.min;
  const Vec3 reach = glm::max(glm::abs(low), glm::abs(high));
  const double slack = 1e-14 * (reach.x + reach.y + reach.z);
  for (const Vec3& normal : cone.plane_normals)
    if (least_of(normal, low, high) > slack) return false;
  if (cone.half_angle_rad >= kFlatRad) return true;
  // The cone's tangent plane nearest to the box's centre; it rejects whatever the bounding sphere of the box would, and more.
  const Vec3 centre = 0.5 * (low + high);
  const Vec3 across = centre - glm::dot(centre, cone.axis) * cone.axis;
  const double distance = glm::length(across);
  if (distance <= slack) return true;
  const Vec3 tangent_normal = cone.cos_half_angle / distance * across - cone.sin_half_angle * cone.axis;
  return least_of(tangent_normal, low, high) <= slack;
}

bool contains(const DirectionCone& cone, const Box& positions, const Vec3& point) {
  return may_see(cone, positions, Box{point, point});
}

}  // namespace standin
