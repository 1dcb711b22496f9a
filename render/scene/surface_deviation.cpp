#include "render/scene/surface_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

namespace standin {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::uint64_t kPiecesBetweenChecks = 1024;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SurfacePoint operator-(const SurfacePoint& a, const SurfacePoint& b) {
  return {a.place - b.place, a.texture - b.texture};
}
SurfacePoint operator+(const SurfacePoint& a, const SurfacePoint& b) {
  return {a.place + b.place, a.texture + b.texture};
}
SurfacePoint operator*(double s, const SurfacePoint& a) {
  return {s * a.place, s * a.texture};
}
double dot(const SurfacePoint& a, const SurfacePoint& b) {
  return glm::dot(a.place, b.place) + glm::dot(a.texture, b.texture);
}
double length(const SurfacePoint& a) {
  return std::sqrt(dot(a, a));
}

double coordinate(const SurfacePoint& p, std::size_t axis) {
  return axis < 3 ? p.place[static_cast<int>(axis)] : p.texture[static_cast<int>(axis) - 3];
}

SurfacePoint centroid(const SurfaceTriangle& t) {
  return (1.0 / 3.0) * (t[0] + t[1] + t[2]);
}

double distance2_to_segment(const SurfacePoint& p, const SurfacePoint& a, const SurfacePoint& b) {
  const SurfacePoint ab = b - a;
  const double length2 = dot(ab, ab);
  const double t = length2 > 0.0 ? std::clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
  const SurfacePoint off = p - (a + t * ab);
  return dot(off, off);
}

// Ericson, Real-Time Collision Detection 5.1.5: Voronoi regions by dot products alone, which mean the same in any dimension.
double distance2(const SurfacePoint& point, const SurfaceTriangle& triangle) {
  const auto& [a, b, c] = triangle;
  const SurfacePoint ab = b - a, ac = c - a, ap = point - a;
  const double d00 = dot(ab, ab), d01 = dot(ab, ac), d11 = dot(ac, ac), d20 = dot(ap, ab), d21 = dot(ap, ac);
  const double denominator = d00 * d11 - d01 * d01;
  if (denominator > 0.0) {
    const double v = (d11 * d20 - d01 * d21) / denominator;
    const double w = (d00 * d21 - d01 * d20) / denominator;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
      const SurfacePoint off = ap - (v * ab + w * ac);
      return dot(off, off);
    }
  }
  return std::min({distance2_to_segment(point, a, b), distance2_to_segment(point, b, c), distance2_to_segment(point, c, a)});
}

bool is_finite(const SurfaceTriangle& triangle) {
  return std::ranges::all_of(triangle, [](const SurfacePoint& p) { return std::isfinite(length(p)); });
}

/// A piece of surface that lies no farther than `bound_m` from the other surface.
struct Piece {
  SurfaceTriangle corners;
  std::uint32_t nearest = 0;  // triangle of the other surface, to the piece's centroid
  double bound_m = 0.0;
  std::uint64_t number = 0;
  friend bool operator<(const Piece& a, const Piece& b) { return a.bound_m != b.bound_m ? a.bound_m < b.bound_m : a.number > b.number; }
};

/// The farthest corner from one triangle: no point between the corners is farther.
double farthest_corner(const SurfaceTriangle& corners, const SurfaceTriangle& from) {
  return std::max({distance(corners[0], from), distance(corners[1], from), distance(corners[2], from)});
}

double farthest_corner(const SurfaceTriangle& corners, const SurfacePoint& from) {
  return std::max({length(corners[0] - from), length(corners[1] - from), length(corners[2] - from)});
}

SurfacePoint between(const SurfacePoint& a, const SurfacePoint& b, double t) {
  return a + t * (b - a);
}

std::size_t longest_edge(const SurfaceTriangle& t) {
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (length(t[(i + 1) % 3] - t[i]) > length(t[(longest + 1) % 3] - t[longest])) longest = i;
  return longest;
}

double edge_length(const SurfaceTriangle& t, std::size_t edge) {
  return length(t[(edge + 1) % 3] - t[edge]);
}

/// A place on one of a piece's edges, given by the corner that the edge starts from (its end is the next corner).
struct Cut {
  std::size_t edge = 0;
  double share = 0.5;
};

// Slivers cut off lead nowhere: then the longest edge is halved.
constexpr double kLeastCut = 0.02;

/// Where a piece leaves what lies over `triangle`: over it, the distance is that from a plane, and what is left takes no more cuts.
std::optional<Cut> cut_at_border(const SurfaceTriangle& piece, const SurfaceTriangle& triangle) {
  std::optional<Cut> best;
  double farthest = 0.0;
  for (std::size_t e = 0; e < 3; ++e) {
    const SurfacePoint &a = triangle[e], &b = triangle[(e + 1) % 3], &c = triangle[(e + 2) % 3];
    const SurfacePoint along = b - a;
    const double along2 = dot(along, along);
    if (!(along2 > 0.0)) continue;
    const SurfacePoint inwards = (c - a) - (dot(c - a, along) / along2) * along;
    const double size = length(inwards);
    if (!(size > 0.0)) continue;
    std::array<double, 3> inside{};
    for (std::size_t i = 0; i < 3; ++i) inside[i] = dot(piece[i] - a, inwards) / size;
    for (std::size_t i = 0; i < 3; ++i) {
      const double from = inside[i], to = inside[(i + 1) % 3];
      const double share = from / (from - to);
      const double outside = -std::min(from, to);
      if (from * to < 0.0 && outside > farthest && share > kLeastCut && share < 1.0 - kLeastCut) {
        farthest = outside;
        best = Cut{i, share};
      }
    }
  }
  return best;
}

Cut cut_of(const SurfaceTriangle& piece, const SurfaceTriangle& nearest) {
  const std::size_t longest = longest_edge(piece);
  if (edge_length(piece, longest) <= 2.0 * edge_length(nearest, longest_edge(nearest)))
    if (const auto cut = cut_at_border(piece, nearest)) return *cut;
  return {longest, 0.5};
}

class DeviationSearch {
 public:
  DeviationSearch(const SurfaceTree& to, const DeviationLimits& limits) : to_(to), limits_(limits) {}

  Deviation run(const Surface& from) {
    look_at_corners(from);
    for (std::size_t t = 0; t < from.triangles.size(); ++t) add(from.corners(t), 0);
    const std::uint64_t most = result_.pieces + limits_.pieces;
    while (!open_.empty() && result_.pieces < most && !(result_.found_m > limits_.refuted_m)) {
      const Piece piece = open_.top();
      if (piece.bound_m <= std::max(settled_m_, tight_m())) break;
      open_.pop();
      divide(piece);
    }
    result_.bound_m = std::max({settled_m_, result_.found_m, open_.empty() ? 0.0 : open_.top().bound_m});
    return result_;
  }

 private:
  [[nodiscard]] double tight_m() const { return std::max(limits_.absolute_m, (1.0 + limits_.relative) * result_.found_m); }

  SurfaceTree::Nearest look_at(const SurfacePoint& point, std::uint32_t guess) {
    const SurfaceTree::Nearest nearest = to_.nearest(point, guess);
    result_.found_m = std::max(result_.found_m, nearest.distance);
    return nearest;
  }

  /// The sooner the greatest distance is found, the fewer pieces need a closer look.
  void look_at_corners(const Surface& from) {
    std::vector<bool> used(from.points.size(), false);
    for (const auto& triangle : from.triangles)
      for (const std::uint32_t v : triangle) used[v] = true;
    std::uint32_t guess = 0;
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v]) guess = look_at(from.points[v], guess).triangle;
  }

  void add(const SurfaceTriangle& corners, std::uint32_t guess) {
    if (limits_.budget != nullptr && result_.pieces % kPiecesBetweenChecks == 0) limits_.budget->check();
    const SurfacePoint middle = centroid(corners);
    const SurfaceTree::Nearest nearest = look_at(middle, guess);
    const double bound_m = std::max(nearest.distance, std::min(nearest.distance + farthest_corner(corners, middle),
                                                               farthest_corner(corners, to_.triangle(nearest.triangle))));
    ++result_.pieces;
    if (bound_m <= tight_m())
      settled_m_ = std::max(settled_m_, bound_m);
    else
      open_.push({corners, nearest.triangle, bound_m, result_.pieces});
  }

  void divide(const Piece& piece) {
    const Cut cut = cut_of(piece.corners, to_.triangle(piece.nearest));
    const SurfacePoint &a = piece.corners[cut.edge], &b = piece.corners[(cut.edge + 1) % 3], &c = piece.corners[(cut.edge + 2) % 3];
    const SurfacePoint middle = between(a, b, cut.share);
    add({a, middle, c}, piece.nearest);
    add({middle, b, c}, piece.nearest);
  }

  const SurfaceTree& to_;
  const DeviationLimits& limits_;
  Deviation result_;
  std::priority_queue<Piece> open_;  // those whose bound is not tight
  double settled_m_ = 0.0;           // the greatest bound of the others
};

}  // namespace

Surface surface_of(const Mesh& mesh, double metres_per_uv) {
  Surface surface;
  surface.points.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    surface.points.push_back({mesh.positions[v], mesh.uvs.empty() ? Vec2(0.0) : metres_per_uv * Vec2(mesh.uvs[v])});
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    surface.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
  return surface;
}

double distance(const SurfacePoint& point, const SurfaceTriangle& triangle) {
  return std::sqrt(distance2(point, triangle));
}

SurfaceTree::SurfaceTree(const Surface& surface) : order_(surface.triangles.size()) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) triangles_.push_back(surface.corners(t));
  finite_ = std::ranges::all_of(triangles_, is_finite);
  std::iota(order_.begin(), order_.end(), 0U);
  if (!triangles_.empty()) build(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t SurfaceTree::build(std::uint32_t first, std::uint32_t last) {
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.min.fill(kInfinity);
  node.max.fill(-kInfinity);
  for (std::uint32_t i = first; i < last; ++i)
    for (const SurfacePoint& corner : triangles_[order_[i]])
      for (std::size_t axis = 0; axis < 5; ++axis) {
        node.min[axis] = std::min(node.min[axis], coordinate(corner, axis));
        node.max[axis] = std::max(node.max[axis], coordinate(corner, axis));
      }
  node.first = first;
  node.count = last - first;
  nodes_.push_back(node);
  if (node.count <= kLeafTriangles) return id;
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 5; ++axis)
    if (node.max[axis] - node.min[axis] > node.max[longest] - node.min[longest]) longest = axis;
  const std::uint32_t half = first + node.count / 2;
  const auto key = [&](std::uint32_t t) { return std::pair(coordinate(centroid(triangles_[t]), longest), t); };
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  build(first, half);
  const std::uint32_t second = build(half, last);
  nodes_[id].first = second;
  nodes_[id].count = 0;
  return id;
}

// From the box of a node, squared.
double SurfaceTree::distance2(const Node& node, const Coordinates& point) {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < point.size(); ++axis) {
    const double outside = std::max(std::max(node.min[axis] - point[axis], point[axis] - node.max[axis]), 0.0);
    sum += outside * outside;
  }
  return sum;
}

SurfaceTree::Nearest SurfaceTree::nearest(const SurfacePoint& point, std::uint32_t guess) const {
  const Coordinates coordinates{point.place.x, point.place.y, point.place.z, point.texture.x, point.texture.y};
  std::uint32_t best = guess;
  double best2 = standin::distance2(point, triangles_[guess]);
  std::array<std::pair<double, std::uint32_t>, 72> open;  // halving 2^32 triangles is no deeper than this
  std::size_t size = 0;
  open[size++] = {distance2(nodes_[0], coordinates), 0U};
  while (size > 0) {
    const auto [near2, id] = open[--size];
    if (near2 >= best2) continue;
    const Node& node = nodes_[id];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (const double d2 = standin::distance2(point, triangles_[order_[i]]); d2 < best2) std::tie(best, best2) = std::pair(order_[i], d2);
    if (node.count > 0) continue;
    std::pair low{distance2(nodes_[id + 1], coordinates), id + 1};
    std::pair high{distance2(nodes_[node.first], coordinates), node.first};
    if (high.first < low.first) std::swap(low, high);
    open[size++] = high;
    open[size++] = low;
  }
  return {best, std::sqrt(best2)};
}

Deviation deviation(const Surface& from, const SurfaceTree& to, const DeviationLimits& limits) {
  if (from.triangles.empty()) return {};
  bool finite = true;
  for (std::size_t t = 0; t < from.triangles.size(); ++t) finite = finite && is_finite(from.corners(t));
  if (to.empty() || !to.finite() || !finite) return {kInfinity, kInfinity, 0};
  return DeviationSearch(to, limits).run(from);
}

ComparedSurface::ComparedSurface(Surface surface) : surface_(std::move(surface)), tree_(surface_) {
  for (std::size_t t = 0; t < surface_.triangles.size(); ++t) keys_.push_back(key_of(surface_.corners(t)));
  sorted_ = keys_;
  if (tree_.finite()) std::ranges::sort(sorted_);  // what is no number has no order
}

ComparedSurface::Key ComparedSurface::key_of(const SurfaceTriangle& corners) {
  Key key;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t axis = 0; axis < 5; ++axis) key[c][axis] = coordinate(corners[c], axis);
  std::ranges::sort(key);
  return key;
}

bool ComparedSurface::has(const Key& triangle) const {
  return tree_.finite() && std::ranges::binary_search(sorted_, triangle);
}

Surface ComparedSurface::without_those_of(const ComparedSurface& other) const {
  if (!tree_.finite()) return surface_;
  Surface own{surface_.points, {}};
  for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
    if (!other.has(keys_[t])) own.triangles.push_back(surface_.triangles[t]);
  return own;
}

Deviation ComparedSurface::deviation_both_ways(const ComparedSurface& other, const DeviationLimits& limits) const {
  const Deviation there = deviation(without_those_of(other), other.tree_, limits);
  if (there.bound_m > limits.refuted_m || there.found_m == kInfinity) return there;
  const Deviation back = deviation(other.without_those_of(*this), tree_, limits);
  return {std::max(there.bound_m, back.bound_m), std::max(there.found_m, back.found_m), there.pieces + back.pieces};
}

}  // namespace standin
