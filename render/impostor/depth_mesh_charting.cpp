#include "render/impostor/depth_mesh_charting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_set>

#include "render/impostor/flat_reduction.h"

namespace standin {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// The side of the lattice a triangle faces most: axis 0, 1, 2 (x, y, layer) and the direction along it.
struct Facing {
  int axis = 2;
  bool positive = false;
  friend bool operator==(const Facing&, const Facing&) = default;
};

Facing facing_of(const LatticeNormal& n) {
  const std::int64_t x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (z >= x && z >= y) return {2, n.z > 0};
  return x >= y ? Facing{0, n.x > 0} : Facing{1, n.y > 0};
}

Vec2 chart_coordinates(const LatticeVertex& v, int axis) {
  const Vec2 texel = texel_coordinates(v);
  return {axis == 0 ? v.layer : texel.x, axis == 1 ? v.layer : texel.y};
}

/// Neighbours of each triangle over its edges, three lists one after the other in order of ids.
std::vector<std::vector<std::uint32_t>> neighbours_over_edges(const SimplifiedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> triangles_of_edge;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
      triangles_of_edge[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  std::vector<std::vector<std::uint32_t>> neighbours(mesh.triangles.size());
  for (const auto& [edge, triangles] : triangles_of_edge)
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t other : triangles)
        if (other != t) neighbours[t].push_back(other);
  return neighbours;
}

using FlatTriangle = std::array<Vec2, 3>;

/// visit(x, y) for each texel whose centre lies within the triangle and not on its outline.
template <class Visit>
void for_each_centre(const FlatTriangle& t, const Visit& visit) {
  const auto cross = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
  const double sign = cross(t[1] - t[0], t[2] - t[0]) < 0.0 ? -1.0 : 1.0;
  const Vec2 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
  for (auto y = static_cast<int>(std::floor(low.y)); y <= high.y; ++y)
    for (auto x = static_cast<int>(std::floor(low.x)); x <= high.x; ++x) {
      const Vec2 centre(x + 0.5, y + 0.5);
      bool inside = true;
      for (std::size_t i = 0; i < 3 && inside; ++i) inside = sign * cross(t[(i + 1) % 3] - t[i], centre - t[i]) > 1e-9;
      if (inside) visit(x, y);
    }
}

class Charting {
 public:
  Charting(const SimplifiedMesh& mesh, double scale, std::uint32_t max_side)
      : mesh_(mesh), scale_(scale), max_side_(max_side), neighbours_(neighbours_over_edges(mesh)), done_(mesh.triangles.size(), 0),
        local_(mesh.vertices.size(), kNone) {
    for (const TriangleCorners& c : mesh.triangles)
      facing_.push_back(facing_of(lattice_normal(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]])));
  }

  [[nodiscard]] std::vector<ChartDraft> run() {
    std::vector<ChartDraft> charts;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (done_[t] == 0) charts.push_back(grow(t));
    return charts;
  }

 private:
  ChartDraft grow(std::uint32_t seed) {
    taken_.clear();
    low_ = Vec2(std::numeric_limits<double>::infinity());
    high_ = -low_;
    std::vector<std::uint32_t> members;
    (void)take(seed, members);
    for (std::size_t i = 0; i < members.size(); ++i)
      for (const std::uint32_t next : neighbours_[members[i]])
        if (done_[next] == 0 && facing_[next] == facing_[seed]) (void)take(next, members);
    return draft(members, facing_[seed].axis);
  }

  /// Adds the triangle unless it would lie upon another or the block would become too large.
  bool take(std::uint32_t t, std::vector<std::uint32_t>& members) {
    FlatTriangle flat;
    Vec2 low = low_, high = high_;
    for (std::size_t i = 0; i < 3; ++i) {
      flat[i] = scale_ * chart_coordinates(mesh_.vertices[mesh_.triangles[t][i]], facing_[t].axis);
      low = glm::min(low, flat[i]);
      high = glm::max(high, flat[i]);
    }
    const Vec2 size = glm::ceil(high) - glm::floor(low);
    if (!members.empty() && std::max(size.x, size.y) > max_side_) return false;
    std::vector<std::uint64_t> centres;
    bool free = true;
    for_each_centre(flat, [&](int x, int y) {
      centres.push_back(static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint32_t>(x));
      free = free && !taken_.contains(centres.back());
    });
    if (!free) return false;
    taken_.insert(centres.begin(), centres.end());
    low_ = low;
    high_ = high;
    done_[t] = 1;
    members.push_back(t);
    return true;
  }

  [[nodiscard]] ChartDraft draft(const std::vector<std::uint32_t>& members, int axis) {
    const Vec2 origin = glm::floor(low_), size = glm::max(glm::ceil(high_) - origin, Vec2(1.0));
    ChartDraft chart{static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y), {}, {}, {}};
    for (const std::uint32_t t : members) {
      TriangleCorners corners = mesh_.triangles[t];
      for (std::uint32_t& corner : corners) {
        if (local_[corner] == kNone) {
          local_[corner] = static_cast<std::uint32_t>(chart.vertices.size());
          chart.vertices.push_back(corner);
          chart.texels.push_back(scale_ * chart_coordinates(mesh_.vertices[corner], axis) - origin);
        }
        corner = local_[corner];
      }
      chart.triangles.push_back(corners);
    }
    for (const std::uint32_t v : chart.vertices) local_[v] = kNone;
    return chart;
  }

  const SimplifiedMesh& mesh_;
  double scale_;
  std::uint32_t max_side_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<Facing> facing_;
  std::vector<std::uint8_t> done_;
  std::vector<std::uint32_t> local_;          // index of a vertex in the chart at hand
  std::unordered_set<std::uint64_t> taken_;   // texels of the chart at hand
  Vec2 low_{0.0}, high_{0.0};
};

}  // namespace

std::vector<ChartDraft> charts_of(const SimplifiedMesh& mesh, double texels_per_voxel, std::uint32_t max_side) {
  return Charting(mesh, texels_per_voxel, max_side).run();
}

}  // namespace standin
