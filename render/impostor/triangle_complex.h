// A set of triangles that edges are contracted in (thesis 4.5), border and all.
//
// Corners are kept in one linked list per vertex, so that edges may have one, two or more triangles: real scenes have surfaces that end on
// others. Vertices never move: contracting an edge removes one of its ends, and the other takes over its triangles. So an edge's length
// never changes while it exists.
#pragma once

#include "render/impostor/depth_mesh.h"

namespace standin {

using TriangleCorners = std::array<std::uint32_t, 3>;

class TriangleComplex {
 public:
  struct Neighbour {
    std::uint32_t vertex = 0;
    std::uint32_t triangles = 0;  // of the edge to it
  };

  /// Triangles 2i and 2i + 1 are polygon i's. Parts that touch in a vertex only get a vertex each.
  explicit TriangleComplex(const DepthMesh& mesh);

  [[nodiscard]] std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(positions_.size()); }
  [[nodiscard]] std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size()); }
  [[nodiscard]] const LatticeVertex& position(std::uint32_t v) const { return positions_[v]; }
  [[nodiscard]] const TriangleCorners& corners(std::uint32_t t) const { return corners_[t]; }
  [[nodiscard]] bool alive(std::uint32_t t) const { return corners_[t][0] != kNone; }

  /// The live triangles at a vertex; none where it has been removed.
  void triangles_of(std::uint32_t v, std::vector<std::uint32_t>& result);
  void neighbours_of(std::uint32_t v, std::vector<Neighbour>& result);
  /// Squared, in half texels and half layers.
  [[nodiscard]] std::int64_t length2(std::uint32_t a, std::uint32_t b) const;

  /// Whether taking `removed` into `kept` leaves border a border and manifold edges manifold: an end of a border edge goes along the border
  /// only, and where it goes straight on in two directions; the only common neighbours are the tips of the triangles that vanish, and the
  /// third corner of a hole that thereby closes.
  [[nodiscard]] bool may_contract(const std::vector<Neighbour>& of_removed, const std::vector<Neighbour>& of_kept, std::uint32_t removed,
                                  std::uint32_t kept) const;
  /// Triangles of the edge vanish, the others of `removed` (its star) take `kept` as corner.
  void contract(std::uint32_t removed, std::uint32_t kept, const std::vector<std::uint32_t>& star);
  /// Gives each set of triangles at v that hang together over edges a vertex of its own; new ones are the last.
  void split_fans(std::uint32_t v);
  void remove(std::uint32_t triangle) { corners_[triangle][0] = kNone; }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  void link(std::uint32_t corner, std::uint32_t vertex);
  [[nodiscard]] bool is_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

  std::vector<LatticeVertex> positions_;
  std::vector<TriangleCorners> corners_;
  std::vector<std::uint32_t> first_corner_;  // of a vertex; corner 3t + i is corners_[t][i]
  std::vector<std::uint32_t> next_corner_;
  std::vector<std::uint32_t> scratch_;
};

[[nodiscard]] inline const TriangleComplex::Neighbour* find_neighbour(const std::vector<TriangleComplex::Neighbour>& neighbours,
                                                                      std::uint32_t vertex) {
  for (const auto& neighbour : neighbours)
    if (neighbour.vertex == vertex) return &neighbour;
  return nullptr;
}

}  // namespace standin
