#include "render/impostor/slab_piece.h"

#include <limits>
#include <utility>

namespace standin {
namespace {

PieceVertex piece_vertex(const FrameVertex& vertex, const Vec3& barycentric) {
  return {vertex.texel, vertex.inverse_depth, vertex.inverse_depth * barycentric};
}

Vec3 unit(std::size_t i) {
  Vec3 result(0.0);
  result[static_cast<int>(i)] = 1.0;
  return result;
}

/// Where the edge crosses the plane at `depth`; its ends lie on different sides.
PieceVertex crossing(const FrameTriangle& triangle, const ImpostorFrame& frame, std::size_t a, std::size_t b, double depth) {
  if (triangle[a].position.z > triangle[b].position.z) std::swap(a, b);
  const Vec3 &from = triangle[a].position, &to = triangle[b].position;
  const double share = (depth - from.z) / (to.z - from.z);
  const Vec3 point(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y), depth);
  return piece_vertex(frame_vertex(frame, point), (1.0 - share) * unit(a) + share * unit(b));
}

/// Keeps what lies on the side of `limit` where sign * (coordinate - limit) >= 0.
Piece clipped(const Piece& piece, int axis, double limit, double sign) {
  Piece result;
  for (std::size_t i = 0; i < piece.count; ++i) {
    const PieceVertex &a = piece.vertices[i], &b = piece.vertices[(i + 1) % piece.count];
    const double inside_a = sign * (a.position[axis] - limit), inside_b = sign * (b.position[axis] - limit);
    if (inside_a >= 0.0) result.add(a);
    if ((inside_a > 0.0 && inside_b < 0.0) || (inside_a < 0.0 && inside_b > 0.0))
      result.add(between(a, b, inside_a / (inside_a - inside_b)));
    if (result.count + 2 > result.vertices.size()) break;  // rounding on a sliver; a convex polygon gains one vertex at most
  }
  return result;
}

}  // namespace

Piece slab_piece(const FrameTriangle& triangle, const ImpostorFrame& frame, double near_m, double far_m) {
  Piece piece;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    const double depth_a = triangle[a].position.z, depth_b = triangle[b].position.z;
    if (near_m <= depth_a && depth_a <= far_m) piece.add(piece_vertex(triangle[a], unit(a)));
    const auto add_crossing = [&](double depth) {
      if ((depth_a < depth && depth < depth_b) || (depth_b < depth && depth < depth_a)) piece.add(crossing(triangle, frame, a, b, depth));
    };
    add_crossing(depth_a < depth_b ? near_m : far_m);  // in the order along the edge
    add_crossing(depth_a < depth_b ? far_m : near_m);
  }
  return piece;
}

Piece texel_piece(const Piece& piece, std::uint32_t x, std::uint32_t y, const Vec2& margin) {
  Piece result = clipped(piece, 0, x - margin.x, 1.0);
  result = clipped(result, 0, x + 1.0 + margin.x, -1.0);
  result = clipped(result, 1, y - margin.y, 1.0);
  return clipped(result, 1, y + 1.0 + margin.y, -1.0);
}

PieceVertex nearest_on_outline(const Piece& piece, const Vec2& point) {
  const auto next = [&](std::size_t i) { return i + 1 < piece.count ? i + 1 : 0; };
  double least = std::numeric_limits<double>::infinity();
  std::size_t edge = 0;
  double edge_share = 0.0;
  for (std::size_t i = 0; i < piece.count; ++i) {
    const Vec2 from = piece.vertices[i].position;
    const Vec2 along = piece.vertices[next(i)].position - from;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0.0 ? glm::clamp(glm::dot(point - from, along) / length2, 0.0, 1.0) : 0.0;
    const Vec2 offset = from + share * along - point;
    const double distance2 = glm::dot(offset, offset);
    if (distance2 < least) {
      least = distance2;
      edge = i;
      edge_share = share;
    }
  }
  return between(piece.vertices[edge], piece.vertices[next(edge)], edge_share);
}

}  // namespace standin
