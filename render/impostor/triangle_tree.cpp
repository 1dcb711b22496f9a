#include "render/impostor/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace standin {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;

/// For slivers, over whose inside no point lies for sure.
Vec3 nearest_on_edges(const std::array<Vec3, 3>& t, const Vec3& point) {
  Vec3 best(1.0, 0.0, 0.0);
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Vec3 way = t[j] - t[i];
    const double length2 = glm::dot(way, way);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(point - t[i], way) / length2, 0.0, 1.0) : 0.0;
    const Vec3 gap = t[i] + share * way - point;
    if (const double distance2 = glm::dot(gap, gap); distance2 < least2) {
      least2 = distance2;
      best = Vec3(0.0);
      best[static_cast<int>(i)] = 1.0 - share;
      best[static_cast<int>(j)] = share;
    }
  }
  return best;
}

Vec3 sum_of(const std::array<Vec3, 3>& t) {
  return t[0] + t[1] + t[2];
}

}  // namespace

// By the region of the plane that the point lies over: a corner's, an edge's or the inside. After C. Ericson, Real-Time Collision
// Detection (2005), 5.1.5.
Vec3 nearest_barycentric(const std::array<Vec3, 3>& t, const Vec3& point) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  const Vec3 from_a = point - t[0], from_b = point - t[1], from_c = point - t[2];
  const double a_ab = glm::dot(ab, from_a), a_ac = glm::dot(ac, from_a);
  if (a_ab <= 0.0 && a_ac <= 0.0) return {1.0, 0.0, 0.0};
  const double b_ab = glm::dot(ab, from_b), b_ac = glm::dot(ac, from_b);
  if (b_ab >= 0.0 && b_ac <= b_ab) return {0.0, 1.0, 0.0};
  const double c_ab = glm::dot(ab, from_c), c_ac = glm::dot(ac, from_c);
  if (c_ac >= 0.0 && c_ab <= c_ac) return {0.0, 0.0, 1.0};

  const double of_c = a_ab * b_ac - b_ab * a_ac;
  if (of_c <= 0.0 && a_ab >= 0.0 && b_ab <= 0.0 && a_ab > b_ab) {
    const double share = a_ab / (a_ab - b_ab);
    return {1.0 - share, share, 0.0};
  }
  const double of_b = c_ab * a_ac - a_ab * c_ac;
  if (of_b <= 0.0 && a_ac >= 0.0 && c_ac <= 0.0 && a_ac > c_ac) {
    const double share = a_ac / (a_ac - c_ac);
    return {1.0 - share, 0.0, share};
  }
  const double of_a = b_ab * c_ac - c_ab * b_ac;
  const double to_c = b_ac - b_ab, to_b = c_ab - c_ac;
  if (of_a <= 0.0 && to_c >= 0.0 && to_b >= 0.0 && to_c + to_b > 0.0) {
    const double share = to_c / (to_c + to_b);
    return {0.0, 1.0 - share, share};
  }
  const Vec3 inside(of_a, of_b, of_c);
  const double sum = of_a + of_b + of_c;
  return sum > 0.0 && std::min({of_a, of_b, of_c}) >= 0.0 ? inside / sum : nearest_on_edges(t, point);
}

TriangleTree::TriangleTree(std::vector<std::array<Vec3, 3>> triangles) : triangles_(std::move(triangles)), order_(triangles_.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

std::uint32_t TriangleTree::build(std::uint32_t first, std::uint32_t last) {
  Box bounds, middles;
  for (std::uint32_t i = first; i < last; ++i) {
    for (const Vec3& corner : triangles_[order_[i]]) bounds.extend(corner);
    middles.extend(sum_of(triangles_[order_[i]]));
  }
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({bounds.min, bounds.max, first, last - first});
  if (last - first <= kLeafTriangles) return id;

  const Vec3 size = middles.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](std::uint32_t s, std::uint32_t t) {
    const double of_s = sum_of(triangles_[s])[axis], of_t = sum_of(triangles_[t])[axis];
    return of_s != of_t ? of_s < of_t : s < t;
  });
  build(first, middle);
  const std::uint32_t high = build(middle, last);
  nodes_[id].first = high;
  nodes_[id].count = 0;
  return id;
}

}  // namespace standin
