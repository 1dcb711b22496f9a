#include "render/impostor/mesh_shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "render/scene/extreme_points.h"

namespace standin {
namespace {

constexpr std::size_t kFaces = 24;  // per mesh: a bound costs microseconds, and a city has millions
constexpr std::size_t kPieces = 2;

// Narrower triangles are left out: rounding must not make one degenerate that is counted on, since what is degenerate is not drawn.
constexpr double kLeastHeightShare = 1e-6;
constexpr double kFlat = 0.99;  // cosine between two triangles that make one face

struct Triangle {
  std::array<std::uint32_t, 3> corner{};  // welded
  Vec3 normal{0.0};                       // its length is twice the area
  double area() const { return 0.5 * glm::length(normal); }
};

/// For each vertex the first one at the same position: files split vertices by normals and texture coordinates.
std::vector<std::uint32_t> weld(const Mesh& mesh) {
  const auto key = [&](std::uint32_t i) { return std::tuple(mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z); };
  std::vector<std::uint32_t> order(mesh.positions.size()), first(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && key(order[k]) == key(order[k - 1]) ? first[order[k - 1]] : order[k];
  return first;
}

Vec3 position(const Mesh& mesh, std::uint32_t vertex) {
  return Vec3(mesh.positions[vertex]);
}

std::vector<Triangle> drawn_triangles(const Mesh& mesh) {
  const auto first = weld(mesh);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle triangle;
    std::array<Vec3, 3> p{Vec3(0.0), Vec3(0.0), Vec3(0.0)};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corner[k] = first[mesh.indices[i + k]];
      p[k] = position(mesh, triangle.corner[k]);
    }
    triangle.normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double longest = std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
    if (glm::length(triangle.normal) > kLeastHeightShare * longest * longest) triangles.push_back(triangle);
  }
  return triangles;
}

/// Triangles by edge, two welded vertices in ascending order.
class EdgeNeighbours {
 public:
  explicit EdgeNeighbours(std::span<const Triangle> triangles) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) edges_.emplace_back(key(triangles[t], k), t);
    std::sort(edges_.begin(), edges_.end());
  }
  template <class Visit>
  void for_each(const Triangle& triangle, std::size_t edge, const Visit& visit) const {
    const auto wanted = key(triangle, edge);
    auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair(wanted, 0U));
    for (; at != edges_.end() && at->first == wanted; ++at) visit(at->second);
  }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  static Edge key(const Triangle& triangle, std::size_t edge) {
    return std::minmax(triangle.corner[edge], triangle.corner[(edge + 1) % 3]);
  }
  std::vector<std::pair<Edge, std::uint32_t>> edges_;
};

/// The corner of `other` that is no end of the edge.
std::uint32_t opposite(const Triangle& other, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t corner : other.corner)
    if (corner != a && corner != b) return corner;
  return a;
}

bool is_convex(const SizeBound::Face& face, const Vec3& normal) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 side = face.corners[(i + 1) % 4] - face.corners[i], next = face.corners[(i + 2) % 4] - face.corners[(i + 1) % 4];
    if (!(glm::dot(glm::cross(side, next), normal) > 0.0)) return false;
  }
  return true;
}

/// The two triangles as one face, where they make a flat convex one.
std::optional<SizeBound::Face> joined(const Mesh& mesh, const Triangle& triangle, std::size_t edge, const Triangle& other) {
  if (std::abs(glm::dot(triangle.normal, other.normal)) < kFlat * glm::length(triangle.normal) * glm::length(other.normal))
    return std::nullopt;
  const std::uint32_t a = triangle.corner[edge], b = triangle.corner[(edge + 1) % 3], c = triangle.corner[(edge + 2) % 3];
  const std::uint32_t d = opposite(other, a, b);
  const SizeBound::Face face{{position(mesh, a), position(mesh, d), position(mesh, b), position(mesh, c)}, 4};
  return is_convex(face, triangle.normal) ? std::optional(face) : std::nullopt;
}

/// Triangles pair up, the largest first, each with its largest neighbour that fits.
std::vector<SizeBound::Face> large_faces(const Mesh& mesh, std::vector<Triangle> triangles) {
  std::stable_sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) { return a.area() > b.area(); });
  const EdgeNeighbours neighbours(triangles);
  std::vector<bool> used(triangles.size(), false);
  std::vector<std::pair<double, SizeBound::Face>> faces;
  for (std::uint32_t t = 0; t < triangles.size() && faces.size() < 2 * kFaces; ++t) {
    if (used[t]) continue;
    const Triangle& triangle = triangles[t];
    std::uint32_t partner = t;
    SizeBound::Face face{{position(mesh, triangle.corner[0]), position(mesh, triangle.corner[1]), position(mesh, triangle.corner[2])}, 3};
    for (std::size_t edge = 0; edge < 3; ++edge)
      neighbours.for_each(triangle, edge, [&](std::uint32_t n) {
        if (n == t || used[n] || (partner != t && n >= partner)) return;
        if (const auto quad = joined(mesh, triangle, edge, triangles[n])) {
          face = *quad;
          partner = n;
        }
      });
    used[t] = used[partner] = true;
    faces.emplace_back(triangle.area() + (partner != t ? triangles[partner].area() : 0.0), face);
  }
  std::stable_sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<SizeBound::Face> largest;
  for (std::size_t i = 0; i < std::min(kFaces, faces.size()); ++i) largest.push_back(faces[i].second);
  return largest;
}

/// Vertices that triangles connect, as sets.
class Pieces {
 public:
  explicit Pieces(std::size_t vertices) : parent_(vertices) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }
  void connect(std::uint32_t a, std::uint32_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<std::vector<Vec3>> large_pieces(const Mesh& mesh, std::span<const Triangle> triangles) {
  Pieces pieces(mesh.positions.size());
  for (const Triangle& triangle : triangles) {
    pieces.connect(triangle.corner[0], triangle.corner[1]);
    pieces.connect(triangle.corner[0], triangle.corner[2]);
  }
  std::map<std::uint32_t, std::vector<Vec3>> vertices;  // by root
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t corner : triangle.corner) vertices[pieces.root(corner)].push_back(position(mesh, corner));
  std::vector<std::pair<double, std::vector<Vec3>>> by_size;
  for (const auto& [root, points] : vertices) {
    Box box;
    for (const Vec3& point : points) box.extend(point);
    by_size.emplace_back(box.diagonal(), extreme_points(points));
  }
  std::stable_sort(by_size.begin(), by_size.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::vector<Vec3>> largest;
  for (std::size_t i = 0; i < std::min(kPieces, by_size.size()); ++i) largest.push_back(std::move(by_size[i].second));
  return largest;
}

}  // namespace

SizeBound::MeshShape shape_of(const Mesh& mesh) {
  const auto triangles = drawn_triangles(mesh);
  return {large_faces(mesh, triangles), large_pieces(mesh, triangles)};
}

}  // namespace standin
