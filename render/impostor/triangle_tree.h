// The triangle nearest to a point: a tree of boxes, halved at the median along the longest side.
//
// Asked once per texel for a surface's own colour and once per original point for the distance to a coarse mesh. Long thin triangles beside
// tiny ones are the rule in models of buildings; a uniform grid lists the former in most of its cells, which took three quarters of a
// LOD-sprite's bake.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// Barycentric coordinates of the triangle's point nearest to `point`.
[[nodiscard]] Vec3 nearest_barycentric(const std::array<Vec3, 3>& triangle, const Vec3& point);
[[nodiscard]] inline Vec3 point_at(const std::array<Vec3, 3>& t, const Vec3& b) {
  return b.x * t[0] + b.y * t[1] + b.z * t[2];
}

class TriangleTree {
 public:
  explicit TriangleTree(std::vector<std::array<Vec3, 3>> triangles);

  struct Nearest {
    std::uint32_t triangle = 0;
    Vec3 barycentric{0.0};
    Vec3 point{0.0};
    double distance = std::numeric_limits<double>::infinity();  // and penalty
  };

  /// The least distance plus penalty(triangle) >= 0, ties to the lower triangle; nothing where none is within `within`, or all are
  /// infinitely far.
  template <class Penalty>
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3& point, double within, const Penalty& penalty) const {
    if (nodes_.empty()) return std::nullopt;
    Nearest best{kNone, Vec3(0.0), Vec3(0.0), within};
    Stack open;
    open.push({0, distance_to(nodes_[0], point)});
    while (!open.empty()) {
      const Open next = open.pop();
      if (next.distance > best.distance) continue;
      const Node& node = nodes_[next.node];
      if (node.count > 0)
        look_at(node, point, penalty, best);
      else
        push_children(node, next.node, point, open);
    }
    return best.triangle != kNone ? std::optional(best) : std::nullopt;
  }
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3& point, double within) const {
    return nearest(point, within, [](std::uint32_t) { return 0.0; });
  }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  /// A leaf has `count` triangles from `first` in order_; else the children are the next node and node `first`.
  struct Node {
    Vec3 min{0.0}, max{0.0};
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Open {
    std::uint32_t node = 0;
    double distance = 0.0;
  };
  /// Halving 2^32 triangles is no deeper than this.
  class Stack {
   public:
    void push(const Open& open) { items_[size_++] = open; }
    Open pop() { return items_[--size_]; }
    [[nodiscard]] bool empty() const { return size_ == 0; }

   private:
    std::array<Open, 72> items_;
    std::size_t size_ = 0;
  };

  [[nodiscard]] static double distance_to(const Node& node, const Vec3& point) {
    return glm::length(glm::max(glm::max(node.min - point, point - node.max), Vec3(0.0)));
  }

  /// The nearer one on top.
  void push_children(const Node& node, std::uint32_t id, const Vec3& point, Stack& open) const {
    const Open low{id + 1, distance_to(nodes_[id + 1], point)}, high{node.first, distance_to(nodes_[node.first], point)};
    open.push(low.distance <= high.distance ? high : low);
    open.push(low.distance <= high.distance ? low : high);
  }

  template <class Penalty>
  void look_at(const Node& leaf, const Vec3& point, const Penalty& penalty, Nearest& best) const {
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      const std::uint32_t t = order_[i];
      const Vec3 b = nearest_barycentric(triangles_[t], point);
      const Vec3 at = point_at(triangles_[t], b);
      const double distance = glm::length(at - point) + penalty(t);
      if (distance < best.distance || (distance == best.distance && t < best.triangle && std::isfinite(distance)))
        best = {t, b, at, distance};
    }
  }

  std::uint32_t build(std::uint32_t first, std::uint32_t last);

  std::vector<std::array<Vec3, 3>> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace standin
