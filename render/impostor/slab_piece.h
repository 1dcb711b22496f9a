// What of a triangle lies between two depths, as a convex polygon in texel coordinates.
//
// A point where a triangle's edge crosses a slab border is computed from the edge alone, nearer end first: both layers at the border, and
// both triangles at the edge, get the same bits, so their pieces meet without a crack (thesis 3.3.2).
#pragma once

#include <array>

#include "render/impostor/impostor.h"

namespace standin {

/// Linear on the image: position in texels, 1/depth, and the barycentric coordinates times that.
struct PieceVertex {
  Vec2 position{0.0};
  double inverse_depth = 0.0;
  Vec3 weights{0.0};

  [[nodiscard]] Vec3 barycentric() const { return weights / inverse_depth; }
};

[[nodiscard]] inline PieceVertex between(const PieceVertex& a, const PieceVertex& b, double share) {
  return {a.position + share * (b.position - a.position), a.inverse_depth + share * (b.inverse_depth - a.inverse_depth),
          a.weights + share * (b.weights - a.weights)};
}

/// Convex polygon; fewer than three vertices, or all on a line, where the surface is seen edge-on.
struct Piece {
  std::array<PieceVertex, 12> vertices;  // 3 corners, one more for each slab border and texel side; the rest is for rounding
  std::size_t count = 0;

  void add(const PieceVertex& vertex) { vertices[count++] = vertex; }
};

/// Texel coordinates of a slope.
[[nodiscard]] inline Vec2 texel_from_slope(const ImpostorFrame& frame, const Vec2& slope) {
  return {(slope.x - frame.slope_min.x) / frame.slope_step.x, (frame.slope_min.y - slope.y) / frame.slope_step.y};
}

/// A vertex in the impostor's frame: x right, y up, z the depth along forward (> 0), from the reference viewpoint; and on the image.
struct FrameVertex {
  Vec3 position{0.0};
  Vec2 texel{0.0};
  double inverse_depth = 0.0;
};

[[nodiscard]] inline FrameVertex frame_vertex(const ImpostorFrame& frame, const Vec3& position) {
  const double inverse_depth = 1.0 / position.z;
  return {position, texel_from_slope(frame, {position.x * inverse_depth, position.y * inverse_depth}), inverse_depth};
}

using FrameTriangle = std::array<FrameVertex, 3>;

[[nodiscard]] Piece slab_piece(const FrameTriangle& triangle, const ImpostorFrame& frame, double near_m, double far_m);

/// The part of a piece in the closed texel [x, x+1] x [y, y+1] with a margin around it.
[[nodiscard]] Piece texel_piece(const Piece& piece, std::uint32_t x, std::uint32_t y, const Vec2& margin = Vec2(0.0));

/// The point of the piece's outline nearest to `point`; the piece has at least one vertex.
[[nodiscard]] PieceVertex nearest_on_outline(const Piece& piece, const Vec2& point);

}  // namespace standin
