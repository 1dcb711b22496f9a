// The triangle nearest to a point: a uniform grid of cells, each with the triangles whose box meets it.
//
// Asked once per texel for a surface's own colour and once per vertex for the distance to a coarse mesh, where the answer lies in the
// point's own cell or next to it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// Barycentric coordinates of the triangle's point nearest to `point`.
[[nodiscard]] Vec3 nearest_barycentric(const std::array<Vec3, 3>& triangle, const Vec3& point);
[[nodiscard]] inline Vec3 point_at(const std::array<Vec3, 3>& t, const Vec3& b) {
  return b.x * t[0] + b.y * t[1] + b.z * t[2];
}

class TriangleGrid {
 public:
  explicit TriangleGrid(std::vector<std::array<Vec3, 3>> triangles);

  struct Nearest {
    std::uint32_t triangle = 0;
    Vec3 barycentric{0.0};
    Vec3 point{0.0};
    double distance = std::numeric_limits<double>::infinity();  // and penalty
  };

  /// The least distance plus penalty(triangle) >= 0; nothing where none is within `within`.
  template <class Penalty>
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3& point, double within, const Penalty& penalty) const {
    Nearest best;
    best.distance = within;
    bool found = false;
    for (int ring = 0; ring <= largest_ring_; ++ring) {
      if ((ring - 1) * cell_m_ > best.distance) break;
      for_each_in_ring(point, ring, [&](std::uint32_t t) {
        const Vec3 b = nearest_barycentric(triangles_[t], point);
        const Vec3 at = point_at(triangles_[t], b);
        if (const double distance = glm::length(at - point) + penalty(t); distance < best.distance || (!found && distance <= within)) {
          best = {t, b, at, distance};
          found = true;
        }
      });
    }
    return found ? std::optional(best) : std::nullopt;
  }
  [[nodiscard]] std::optional<Nearest> nearest(const Vec3& point, double within) const {
    return nearest(point, within, [](std::uint32_t) { return 0.0; });
  }

 private:
  using Cell = std::array<int, 3>;

  [[nodiscard]] Cell cell_of(const Vec3& point) const;
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(x);
  }

  /// Triangles of the cells `ring` steps from the point's own, of the shell alone.
  template <class Visit>
  void for_each_in_ring(const Vec3& point, int ring, const Visit& visit) const {
    const Cell c = cell_of(point);
    for (int z = std::max(c[2] - ring, 0); z <= std::min(c[2] + ring, count_[2] - 1); ++z)
      for (int y = std::max(c[1] - ring, 0); y <= std::min(c[1] + ring, count_[1] - 1); ++y) {
        const bool inside = std::abs(z - c[2]) < ring && std::abs(y - c[1]) < ring;
        for (int x = c[0] - ring; x <= c[0] + ring; x += inside && ring > 0 ? 2 * ring : 1) {
          if (x < 0 || x >= count_[0]) continue;
          const std::size_t at = index(x, y, z);
          for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) visit(members_[i]);
        }
      }
  }

  std::vector<std::array<Vec3, 3>> triangles_;
  Vec3 origin_{0.0};
  double cell_m_ = 1.0;
  Cell count_{1, 1, 1};
  int largest_ring_ = 0;
  std::vector<std::uint32_t> first_;  // of each cell's members
  std::vector<std::uint32_t> members_;
};

}  // namespace standin
