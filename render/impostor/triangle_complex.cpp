#include "render/impostor/triangle_complex.h"

#include <algorithm>

namespace standin {
namespace {

bool has_corner(const TriangleCorners& corners, std::uint32_t v) {
  return corners[0] == v || corners[1] == v || corners[2] == v;
}

/// Whether two triangles at vertex v share an edge at v.
bool share_edge(const TriangleCorners& a, const TriangleCorners& b, std::uint32_t v) {
  return std::any_of(a.begin(), a.end(), [&](std::uint32_t corner) { return corner != v && has_corner(b, corner); });
}

}  // namespace

TriangleComplex::TriangleComplex(const DepthMesh& mesh)
    : positions_(mesh.vertices), first_corner_(mesh.vertices.size(), kNone), next_corner_(6 * mesh.polygons.size(), kNone) {
  corners_.reserve(2 * mesh.polygons.size());
  for (const DepthPolygon& polygon : mesh.polygons) {
    const auto& c = polygon.corners;
    corners_.push_back({c[0], c[1], c[2]});
    corners_.push_back({c[0], c[2], c[3]});
  }
  for (std::uint32_t t = triangle_count(); t-- > 0;)
    for (std::uint32_t i = 3; i-- > 0;) link(3 * t + i, corners_[t][i]);
  const std::uint32_t vertices = vertex_count();
  for (std::uint32_t v = 0; v < vertices; ++v) split_fans(v);
}

void TriangleComplex::link(std::uint32_t corner, std::uint32_t vertex) {
  next_corner_[corner] = first_corner_[vertex];
  first_corner_[vertex] = corner;
}

void TriangleComplex::split_fans(std::uint32_t v) {
  std::vector<std::uint32_t>& star = scratch_;
  triangles_of(v, star);
  std::size_t fan = 0;  // star[0, fan) hangs together
  for (std::size_t next = star.empty() ? 0 : 1; next > fan;) {
    fan = next;
    for (std::size_t i = fan; i < star.size(); ++i)
      for (std::size_t k = 0; k < next; ++k)
        if (share_edge(corners_[star[i]], corners_[star[k]], v)) {
          std::swap(star[next++], star[i]);
          break;
        }
  }
  if (fan == star.size()) return;
  const std::uint32_t twin = vertex_count();
  positions_.push_back(positions_[v]);
  first_corner_.push_back(kNone);
  first_corner_[v] = kNone;
  const std::vector<std::uint32_t> triangles = star;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (corners_[triangles[i]][k] == v) link(3 * triangles[i] + k, corners_[triangles[i]][k] = i < fan ? v : twin);
  split_fans(twin);
}

void TriangleComplex::triangles_of(std::uint32_t v, std::vector<std::uint32_t>& result) {
  result.clear();
  for (std::uint32_t* corner = &first_corner_[v]; *corner != kNone;) {
    const std::uint32_t triangle = *corner / 3;
    if (alive(triangle)) {
      result.push_back(triangle);
      corner = &next_corner_[*corner];
    } else {
      *corner = next_corner_[*corner];
    }
  }
}

void TriangleComplex::neighbours_of(std::uint32_t v, std::vector<Neighbour>& result) {
  triangles_of(v, scratch_);
  result.clear();
  for (const std::uint32_t t : scratch_)
    for (const std::uint32_t corner : corners_[t]) {
      if (corner == v) continue;
      const auto known = std::find_if(result.begin(), result.end(), [&](const Neighbour& n) { return n.vertex == corner; });
      if (known != result.end())
        ++known->triangles;
      else
        result.push_back({corner, 1});
    }
}

std::int64_t TriangleComplex::length2(std::uint32_t a, std::uint32_t b) const {
  const std::int64_t dx = positions_[a].x - positions_[b].x, dy = positions_[a].y - positions_[b].y;
  const std::int64_t dz = positions_[a].depth - positions_[b].depth;
  return dx * dx + dy * dy + dz * dz;
}

bool TriangleComplex::may_contract(const std::vector<Neighbour>& of_removed, const std::vector<Neighbour>& of_kept, std::uint32_t removed,
                                   std::uint32_t kept) const {
  const Neighbour* edge = find_neighbour(of_removed, kept);
  int borders = 0;
  for (const Neighbour& n : of_removed) borders += n.triangles != 2;
  if (borders != 0 && (borders != 2 || edge->triangles == 2)) return false;
  std::uint32_t tips = 0;
  for (const Neighbour& n : of_removed) {
    const Neighbour* other = n.vertex == kept ? nullptr : find_neighbour(of_kept, n.vertex);
    if (other == nullptr) continue;
    if (!is_triangle(removed, kept, n.vertex)) {
      if (n.triangles != 1 || other->triangles != 1 || edge->triangles != 1) return false;
      continue;
    }
    ++tips;
    const std::uint32_t merged = n.triangles + other->triangles - 2;
    if (merged == 0 || merged > std::max(n.triangles, other->triangles)) return false;
  }
  return tips == edge->triangles;
}

bool TriangleComplex::is_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  for (std::uint32_t corner = first_corner_[a]; corner != kNone; corner = next_corner_[corner]) {
    const TriangleCorners& corners = corners_[corner / 3];
    if (alive(corner / 3) && has_corner(corners, b) && has_corner(corners, c)) return true;
  }
  return false;
}

void TriangleComplex::contract(std::uint32_t removed, std::uint32_t kept, const std::vector<std::uint32_t>& star) {
  first_corner_[removed] = kNone;
  for (const std::uint32_t t : star) {
    if (has_corner(corners_[t], kept)) {
      corners_[t][0] = kNone;
      continue;
    }
    const auto i = static_cast<std::uint32_t>(std::find(corners_[t].begin(), corners_[t].end(), removed) - corners_[t].begin());
    corners_[t][i] = kept;
    link(3 * t + i, kept);
  }
}

}  // namespace standin
