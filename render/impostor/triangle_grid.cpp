#include "render/impostor/triangle_grid.h"

namespace standin {
namespace {

constexpr double kMostCells = 64.0;  // along the longest side

Box bounds_of(const std::array<Vec3, 3>& t) {
  Box box;
  for (const Vec3& corner : t) box.extend(corner);
  return box;
}

/// The point of edge `i` nearest to `point`.
Vec3 nearest_on_edge(const std::array<Vec3, 3>& t, std::size_t i, const Vec3& point) {
  const std::size_t j = (i + 1) % 3;
  const Vec3 way = t[j] - t[i];
  const double length2 = glm::dot(way, way);
  const double share = length2 > 0.0 ? std::clamp(glm::dot(point - t[i], way) / length2, 0.0, 1.0) : 0.0;
  Vec3 b(0.0);
  b[static_cast<int>(i)] = 1.0 - share;
  b[static_cast<int>(j)] = share;
  return b;
}

}  // namespace

Vec3 nearest_barycentric(const std::array<Vec3, 3>& t, const Vec3& point) {
  const Vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0.0) {
    const auto weight = [&](std::size_t i) { return glm::dot(normal, glm::cross(t[(i + 1) % 3] - point, t[(i + 2) % 3] - point)) / area2; };
    if (const Vec3 b(weight(0), weight(1), weight(2)); b.x >= 0.0 && b.y >= 0.0 && b.z >= 0.0) return b;
  }
  Vec3 best = nearest_on_edge(t, 0, point);
  for (const std::size_t edge : {1U, 2U})
    if (const Vec3 b = nearest_on_edge(t, edge, point); glm::length(point_at(t, b) - point) < glm::length(point_at(t, best) - point))
      best = b;
  return best;
}

TriangleGrid::TriangleGrid(std::vector<std::array<Vec3, 3>> triangles) : triangles_(std::move(triangles)) {
  Box bounds;
  for (const auto& t : triangles_) bounds.extend(bounds_of(t));
  if (bounds.empty()) bounds.extend(Vec3(0.0));
  const Vec3 size = bounds.size();
  origin_ = bounds.min;
  const double longest = std::max({size.x, size.y, size.z});
  if (longest > 0.0) cell_m_ = longest / std::clamp(std::sqrt(static_cast<double>(triangles_.size())), 1.0, kMostCells);
  for (std::size_t axis = 0; axis < 3; ++axis) count_[axis] = 1 + static_cast<int>(size[static_cast<int>(axis)] / cell_m_);
  largest_ring_ = std::max({count_[0], count_[1], count_[2]});

  const auto for_each_cell = [&](const std::array<Vec3, 3>& t, const auto& visit) {
    const Box box = bounds_of(t);
    const Cell low = cell_of(box.min), high = cell_of(box.max);
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) visit(index(x, y, z));
  };
  first_.assign(index(count_[0] - 1, count_[1] - 1, count_[2] - 1) + 2, 0);
  for (const auto& t : triangles_) for_each_cell(t, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  members_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) for_each_cell(triangles_[t], [&](std::size_t cell) { members_[next[cell]++] = t; });
}

TriangleGrid::Cell TriangleGrid::cell_of(const Vec3& point) const {
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    cell[axis] = static_cast<int>(std::clamp(std::floor((point[a] - origin_[a]) / cell_m_), 0.0, count_[axis] - 1.0));
  }
  return cell;
}

}  // namespace standin
