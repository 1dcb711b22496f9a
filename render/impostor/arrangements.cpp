#include "render/impostor/arrangements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kQuarterPi = 0.78539816339744830962;

/// How far the box lies beyond the cell along -x +x -y +y -z +z; negative: not wholly beyond.
std::array<double, 6> gaps_between(const Box& object, const Box& cell) {
  std::array<double, 6> gaps{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = 2 * static_cast<std::size_t>(axis);
    gaps[low] = cell.min[axis] - object.max[axis];
    gaps[low + 1] = object.min[axis] - cell.max[axis];
  }
  return gaps;
}

/// Distance between two boxes, 0 where they meet.
double distance_between(const std::array<double, 6>& gaps) {
  Vec3 apart(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = 2 * static_cast<std::size_t>(axis);
    apart[axis] = std::max({0.0, gaps[low], gaps[low + 1]});
  }
  return glm::length(apart);
}

/// A shaft about the middle of the face's patch [a0, a1] x [b0, b1] (angles) that holds all its directions beyond `distance_m`.
Shaft shaft_over_patch(const Vec3& centre, int face, double a0, double a1, double b0, double b1, double distance_m) {
  const auto direction = [&](double a, double b) {
    Vec3 d(0.0);
    d[face / 2] = face % 2 == 0 ? -1.0 : 1.0;
    d[(face / 2 + 1) % 3] = std::tan(a);
    d[(face / 2 + 2) % 3] = std::tan(b);
    return glm::normalize(d);
  };
  Shaft shaft = shaft_frame(centre, direction(0.5 * (a0 + a1), 0.5 * (b0 + b1)));
  double least_cosine = 1.0;
  // The patch is the convex hull of its corners, and so is its image on the shaft's plane.
  for (const Vec3& corner : {direction(a0, b0), direction(a0, b1), direction(a1, b0), direction(a1, b1)}) {
    const double cosine = glm::dot(corner, shaft.axis);
    const Vec2 tangent = glm::abs(Vec2(glm::dot(corner, shaft.right), glm::dot(corner, shaft.up)) / cosine);
    shaft.tan_half = glm::max(shaft.tan_half, tangent);
    least_cosine = std::min(least_cosine, cosine);
  }
  constexpr double kRoundingSlack = 1e-12;  // neighbours overlap rather than part
  shaft.tan_half *= 1.0 + kRoundingSlack;
  shaft.min_distance_m = distance_m * least_cosine * (1.0 - kRoundingSlack);
  return shaft;
}

}  // namespace

std::vector<BakeRequest> environment_map_requests(const Scene& scene, const Box& cell, double far_field_m) {
  std::vector<std::uint32_t> all(scene.objects.size());
  std::iota(all.begin(), all.end(), 0U);
  return environment_map_requests(scene, all, cell, far_field_m);
}

std::vector<BakeRequest> environment_map_requests(const Scene& scene, std::span<const std::uint32_t> objects, const Box& cell,
                                                  double far_field_m) {
  if (!(far_field_m > 0.0))
    throw Failure(ErrorWord::kBadUsage, "environment map: far field " + std::to_string(far_field_m) + " m violates: > 0");
  std::array<std::vector<std::uint32_t>, 6> faces;
  for (const std::uint32_t id : objects) {
    const auto gaps = gaps_between(scene.objects[id].bounds, cell);
    if (!(distance_between(gaps) >= far_field_m)) continue;
    const auto farthest = std::max_element(gaps.begin(), gaps.end());
    faces[static_cast<std::size_t>(farthest - gaps.begin())].push_back(id);
  }
  std::vector<BakeRequest> requests;
  for (auto& of_face : faces)
    if (!of_face.empty()) requests.push_back({std::move(of_face), cell});
  return requests;
}

std::vector<BakeRequest> view_independent_requests(const Scene& scene, const std::vector<std::uint32_t>& objects, double distance_m,
                                                   std::uint32_t per_face_side) {
  if (objects.empty() || per_face_side == 0 || !(distance_m > 0.0))
    throw Failure(ErrorWord::kBadUsage, "view-independent impostors of " + std::to_string(objects.size()) + " objects from " +
                                            std::to_string(distance_m) + " m, " + std::to_string(per_face_side) +
                                            " patches a side violate: each > 0");
  Box bounds;
  for (const std::uint32_t id : objects) bounds.extend(scene.objects.at(id).bounds);
  const auto angle = [&](std::uint32_t i) { return kQuarterPi * (2.0 * i / per_face_side - 1.0); };
  std::vector<BakeRequest> requests;
  for (int face = 0; face < 6; ++face)
    for (std::uint32_t i = 0; i < per_face_side; ++i)
      for (std::uint32_t j = 0; j < per_face_side; ++j)
        requests.push_back({objects, shaft_over_patch(bounds.centre(), face, angle(i), angle(i + 1), angle(j), angle(j + 1), distance_m)});
  return requests;
}

}  // namespace standin
