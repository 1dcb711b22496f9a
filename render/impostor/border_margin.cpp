#include "render/impostor/border_margin.h"

#include <algorithm>
#include <map>

namespace standin {
namespace {

/// Texels and layers.
Vec3 place(const LatticeVertex& v) {
  return {texel_coordinates(v), 0.5 * v.depth};
}

/// Unit vector in the triangle's plane, normal to the edge from a to b and away from the tip; zero for a triangle without area.
Vec3 outward(const Vec3& a, const Vec3& b, const Vec3& tip) {
  const Vec3 along = b - a, inward = tip - a;
  const Vec3 away = glm::dot(inward, along) / glm::dot(along, along) * along - inward;
  const double length = glm::length(away);
  return length > 1e-9 ? away / length : Vec3(0.0);
}

struct BorderEdge {
  std::uint32_t tip = 0;
  std::uint32_t triangles = 0;
};

}  // namespace

void widen_borders(SimplifiedDepthMesh& mesh, double margin) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, BorderEdge> edges;
  for (const TriangleCorners& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      BorderEdge& edge = edges[std::minmax(t[i], t[(i + 1) % 3])];
      edge.tip = t[(i + 2) % 3];
      ++edge.triangles;
    }
  std::vector<std::vector<Vec3>> normals(mesh.vertices.size());
  for (const auto& [ends, edge] : edges) {
    if (edge.triangles != 1) continue;
    const Vec3 n = outward(place(mesh.vertices[ends.first]), place(mesh.vertices[ends.second]), place(mesh.vertices[edge.tip]));
    normals[ends.first].push_back(n);
    normals[ends.second].push_back(n);
  }
  mesh.shifts.assign(mesh.vertices.size(), Vec3(0.0));
  for (std::size_t v = 0; v < normals.size(); ++v) {
    Vec3 sum(0.0);
    for (const Vec3& n : normals[v]) sum += n;
    if (glm::length(sum) < 1e-9) continue;
    const Vec3 direction = glm::normalize(sum);
    double least = 1.0;  // share of the way that counts for an edge
    for (const Vec3& n : normals[v]) least = std::min(least, glm::dot(n, direction));
    mesh.shifts[v] = margin / std::max(least, 0.5) * direction * Vec3(1.0, 1.0, 2.0);
  }
}

}  // namespace standin
