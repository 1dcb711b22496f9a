#include "render/impostor/depth_mesh_charting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_set>

#include "render/impostor/border_margin.h"
#include "render/impostor/flat_reduction.h"

namespace standin {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
constexpr std::size_t kMostToTurn = 16;  // triangles of a chart that is turned; larger ones fill their blocks well enough

/// The side of the lattice a chart is seen from: axis 0, 1, 2 (x, y, layer) and the direction along it.
struct Facing {
  int axis = 2;
  bool positive = false;
};

std::array<std::int64_t, 3> components(const LatticeNormal& n) {
  return {n.x, n.y, n.z};
}

/// The side a triangle faces most; of equals the view's.
Facing facing_of(const LatticeNormal& n) {
  const auto c = components(n);
  int axis = 2;
  for (const int other : {0, 1})
    if (std::abs(c[static_cast<std::size_t>(other)]) > std::abs(c[static_cast<std::size_t>(axis)])) axis = other;
  return {axis, c[static_cast<std::size_t>(axis)] > 0};
}

/// Whether a triangle may be seen from that side: it is no more than about halved in size there, or no more than a voxel of it is lost.
bool faces(const std::array<LatticeVertex, 3>& t, const LatticeNormal& n, const Facing& facing) {
  const auto c = components(n);
  const std::int64_t along = facing.positive ? c[static_cast<std::size_t>(facing.axis)] : -c[static_cast<std::size_t>(facing.axis)];
  if (2 * along >= std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])})) return true;
  const auto place = [&](const LatticeVertex& v) { return facing.axis == 0 ? v.x : facing.axis == 1 ? v.y : v.depth; };
  const auto [low, high] = std::minmax({place(t[0]), place(t[1]), place(t[2])});
  return along >= 0 && high - low <= 2;
}

Vec2 chart_coordinates(const SimplifiedDepthMesh& mesh, std::uint32_t v, int axis) {
  const Vec3 place = shifted_place(mesh, v);
  return {axis == 0 ? 0.5 * place.z : place.x, axis == 1 ? 0.5 * place.z : place.y};
}

/// Neighbours of each triangle over its edges, three lists one after the other in order of ids.
std::vector<std::vector<std::uint32_t>> neighbours_over_edges(const SimplifiedDepthMesh& mesh) {
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

struct Rect {
  Vec2 low{std::numeric_limits<double>::infinity()};
  Vec2 high{-std::numeric_limits<double>::infinity()};

  void extend(const Rect& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  [[nodiscard]] Vec2 texels() const { return glm::max(glm::ceil(high) - glm::floor(low), Vec2(1.0)); }
  /// Of its place in the atlas, with a gutter of one texel.
  [[nodiscard]] double cost() const { return (texels().x + 2.0) * (texels().y + 2.0); }
};

Rect bounds_of(const FlatTriangle& t) {
  return {glm::min(t[0], glm::min(t[1], t[2])), glm::max(t[0], glm::max(t[1], t[2]))};
}

/// A rotation in the plane of a chart.
struct Turn {
  double cosine = 1.0, sine = 0.0;

  [[nodiscard]] bool identity() const { return sine == 0.0 && cosine == 1.0; }
  [[nodiscard]] Vec2 operator()(const Vec2& p) const { return {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y}; }
};

/// Grows charts from the largest triangles. The next triangle is the neighbour whose addition saves most against a block of its own; growth
/// ends where none saves anything.
class Charting {
 public:
  Charting(const SimplifiedDepthMesh& mesh, double scale, std::uint32_t max_side)
      : mesh_(mesh),
        scale_(scale),
        max_side_(max_side),
        neighbours_(neighbours_over_edges(mesh)),
        done_(mesh.triangles.size(), 0),
        local_(mesh.vertices.size(), kNone) {
    for (const TriangleCorners& c : mesh.triangles)
      normals_.push_back(lattice_normal(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]));
  }

  [[nodiscard]] std::vector<ChartDraft> run() {
    std::vector<std::uint32_t> seeds(mesh_.triangles.size());
    std::iota(seeds.begin(), seeds.end(), 0U);
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return dot(normals_[a], normals_[a]) > dot(normals_[b], normals_[b]); });
    std::vector<ChartDraft> charts;
    for (const std::uint32_t t : seeds)
      if (done_[t] == 0) charts.push_back(grow(t));
    return charts;
  }

 private:
  ChartDraft grow(std::uint32_t seed) {
    facing_ = facing_of(normals_[seed]);
    taken_.clear();
    bounds_ = Rect{};
    members_.clear();
    frontier_.clear();
    take(seed);
    while (!frontier_.empty()) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < frontier_.size(); ++i)
        if (saving(frontier_[i]) > saving(frontier_[best])) best = i;
      const std::uint32_t next = frontier_[best];
      if (saving(next) < 0.0) break;
      frontier_.erase(frontier_.begin() + static_cast<std::ptrdiff_t>(best));
      if (is_free(next)) take(next);
    }
    return draft();
  }

  [[nodiscard]] std::array<LatticeVertex, 3> corners_of(std::uint32_t t) const {
    const TriangleCorners& c = mesh_.triangles[t];
    return {mesh_.vertices[c[0]], mesh_.vertices[c[1]], mesh_.vertices[c[2]]};
  }

  [[nodiscard]] FlatTriangle flat(std::uint32_t t) const {
    FlatTriangle result;
    for (std::size_t i = 0; i < 3; ++i) result[i] = scale_ * chart_coordinates(mesh_, mesh_.triangles[t][i], facing_.axis);
    return result;
  }

  /// Texels that the atlas saves if the triangle joins; negative also where the block would become too large.
  [[nodiscard]] double saving(std::uint32_t t) const {
    const Rect alone = bounds_of(flat(t));
    Rect joined = bounds_;
    joined.extend(alone);
    if (std::max(joined.texels().x, joined.texels().y) > max_side_) return -1.0;
    return alone.cost() + bounds_.cost() - joined.cost();
  }

  /// Whether the triangle lies upon none of the chart.
  [[nodiscard]] bool is_free(std::uint32_t t) const {
    bool free = true;
    for_each_centre(flat(t), [&](int x, int y) { free = free && !taken_.contains(key(x, y)); });
    return free;
  }

  void take(std::uint32_t t) {
    for_each_centre(flat(t), [&](int x, int y) { taken_.insert(key(x, y)); });
    bounds_.extend(bounds_of(flat(t)));
    done_[t] = 1;
    members_.push_back(t);
    for (const std::uint32_t next : neighbours_[t])
      if (done_[next] == 0 && faces(corners_of(next), normals_[next], facing_) &&
          std::find(frontier_.begin(), frontier_.end(), next) == frontier_.end())
        frontier_.push_back(next);
  }

  static std::uint64_t key(int x, int y) { return static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint32_t>(x); }

  [[nodiscard]] ChartDraft draft() {
    const Turn turn = best_turn();
    const Rect bounds = bounds_turned(turn);
    const Vec2 origin = turn.identity() ? glm::floor(bounds.low) : bounds.low;
    const Vec2 size = turn.identity() ? bounds.texels() : glm::max(glm::ceil(bounds.high - bounds.low - 1e-9), Vec2(1.0));
    ChartDraft chart{static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y), {}, {}, {}};
    for (const std::uint32_t t : members_) {
      TriangleCorners corners = mesh_.triangles[t];
      for (std::uint32_t& corner : corners) {
        if (local_[corner] == kNone) {
          local_[corner] = static_cast<std::uint32_t>(chart.vertices.size());
          chart.vertices.push_back(corner);
          chart.texels.push_back(turn(scale_ * chart_coordinates(mesh_, corner, facing_.axis)) - origin);
        }
        corner = local_[corner];
      }
      chart.triangles.push_back(corners);
    }
    for (const std::uint32_t v : chart.vertices) local_[v] = kNone;
    return chart;
  }

  [[nodiscard]] FlatTriangle flat(std::uint32_t t, const Turn& turn) const {
    FlatTriangle result = flat(t);
    for (Vec2& corner : result) corner = turn(corner);
    return result;
  }

  [[nodiscard]] Rect bounds_turned(const Turn& turn) const {
    Rect bounds;
    for (const std::uint32_t t : members_) bounds.extend(bounds_of(flat(t, turn)));
    return bounds;
  }

  /// An edge of the chart along the block's side often wastes least; of equals the first, which is the lattice's own direction.
  [[nodiscard]] Turn best_turn() const {
    Turn best;
    if (members_.size() > kMostToTurn) return best;
    double least = bounds_.cost();
    for (const std::uint32_t t : members_) {
      const FlatTriangle corners = flat(t);
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec2 edge = corners[(i + 1) % 3] - corners[i];
        const double length = glm::length(edge);
        if (length < 1e-9) continue;
        const Turn turn{edge.x / length, -edge.y / length};
        const Rect bounds = bounds_turned(turn);
        const Vec2 size = glm::ceil(bounds.high - bounds.low - 1e-9) + 2.0;
        if (size.x * size.y >= least || std::max(size.x, size.y) > max_side_ || !lies_open(turn, bounds.low)) continue;
        least = size.x * size.y;
        best = turn;
      }
    }
    return best;
  }

  /// Whether no texel centre is in two triangles.
  [[nodiscard]] bool lies_open(const Turn& turn, const Vec2& origin) const {
    std::unordered_set<std::uint64_t> taken;
    bool open = true;
    for (const std::uint32_t t : members_) {
      FlatTriangle corners = flat(t, turn);
      for (Vec2& corner : corners) corner -= origin;
      for_each_centre(corners, [&](int x, int y) { open = open && taken.insert(key(x, y)).second; });
    }
    return open;
  }

  const SimplifiedDepthMesh& mesh_;
  double scale_;
  std::uint32_t max_side_;
  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<LatticeNormal> normals_;
  std::vector<std::uint8_t> done_;
  std::vector<std::uint32_t> local_;  // index of a vertex in the chart at hand
  // The chart at hand:
  Facing facing_;
  Rect bounds_;
  std::vector<std::uint32_t> members_;
  std::vector<std::uint32_t> frontier_;      // neighbours that may join
  std::unordered_set<std::uint64_t> taken_;  // texels
};

}  // namespace

std::vector<ChartDraft> charts_of(const SimplifiedDepthMesh& mesh, double texels_per_voxel, std::uint32_t max_side) {
  return Charting(mesh, texels_per_voxel, max_side).run();
}

}  // namespace standin
