#include "render/impostor/sprite_mesh.h"

#include <meshoptimizer.h>

#include <cmath>

#include "render/impostor/sprite_contraction.h"
#include "render/impostor/sprite_error.h"

namespace standin {
namespace {

// The search for the largest clusters, in units of alpha at the nearest point.
constexpr double kLargestError = 4.0;
constexpr double kSmallestError = 0.03;
constexpr double kClusteringShare = 0.25;  // of alpha; contraction has the rest
constexpr double kErrorStep = 0.70710678118654752440;

struct WeldedSurface {
  std::vector<glm::vec3> positions;
  std::vector<unsigned int> indices;
};

WeldedSurface welded(const std::vector<SurfaceTriangle>& surface) {
  std::vector<glm::vec3> corners;
  for (const SurfaceTriangle& triangle : surface)
    for (const Vec3& corner : triangle.corners) corners.emplace_back(corner);
  std::vector<unsigned int> remap(corners.size());
  const std::size_t count =
      meshopt_generateVertexRemap(remap.data(), nullptr, corners.size(), corners.data(), corners.size(), sizeof(glm::vec3));
  WeldedSurface result{std::vector<glm::vec3>(count), {}};
  meshopt_remapVertexBuffer(result.positions.data(), corners.data(), corners.size(), sizeof(glm::vec3), remap.data());
  for (std::size_t i = 0; i + 2 < remap.size(); i += 3) {
    if (remap[i] == remap[i + 1] || remap[i + 1] == remap[i + 2] || remap[i + 2] == remap[i]) continue;
    result.indices.insert(result.indices.end(), {remap[i], remap[i + 1], remap[i + 2]});
  }
  return result;
}

/// The triangles with the vertices that they use.
SpriteMesh compact(const WeldedSurface& surface) {
  const std::vector<unsigned int>& indices = surface.indices;
  std::vector<std::uint32_t> place(surface.positions.size(), 0);  // + 1
  SpriteMesh mesh;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    TriangleCorners triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& at = place[indices[i + k]];
      if (at == 0) {
        mesh.vertices.emplace_back(surface.positions[indices[i + k]]);
        at = static_cast<std::uint32_t>(mesh.vertices.size());
      }
      triangle[k] = at - 1;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// Simplified to an error in metres, within its own vertices.
std::vector<unsigned int> by_clustering(const WeldedSurface& surface, double error_m) {
  std::vector<unsigned int> indices(surface.indices.size());
  const float* positions = &surface.positions.front().x;
  const float scale = meshopt_simplifyScale(positions, surface.positions.size(), sizeof(glm::vec3));
  indices.resize(meshopt_simplifySloppy(indices.data(), surface.indices.data(), surface.indices.size(), positions, surface.positions.size(),
                                        sizeof(glm::vec3), 0, static_cast<float>(error_m) / scale, nullptr));
  return indices;
}

std::vector<Vec3> judged_points(const WeldedSurface& surface) {
  std::vector<Vec3> points(surface.positions.begin(), surface.positions.end());
  for (std::size_t i = 0; i + 2 < surface.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return Vec3(surface.positions[surface.indices[i + k]]); };
    points.push_back((corner(0) + corner(1) + corner(2)) / 3.0);
  }
  return points;
}

}  // namespace

std::vector<std::array<Vec3, 3>> corners_of(const SpriteMesh& mesh) {
  std::vector<std::array<Vec3, 3>> corners;
  for (const TriangleCorners& t : mesh.triangles) corners.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return corners;
}

SpriteMesh sprite_mesh(const std::vector<SurfaceTriangle>& surface, const Vec3& forward, std::span<const Vec3> viewpoints, double alpha_rad,
                       double nearest_m, const WorkBudget& budget) {
  const WeldedSurface original = welded(surface);
  const std::vector<Vec3> points = judged_points(original);
  SpriteMesh base = compact(original);
  for (double error = kLargestError; error >= kSmallestError && !base.triangles.empty(); error *= kErrorStep) {
    budget.check();
    SpriteMesh clustered = compact({original.positions, by_clustering(original, error * alpha_rad * nearest_m)});
    if (clustered.triangles.size() >= base.triangles.size()) break;
    if (!SpriteError(corners_of(clustered), forward, viewpoints).within(points, kClusteringShare * alpha_rad)) continue;
    base = std::move(clustered);
    break;
  }
  return contracted(base, points, viewpoints, alpha_rad, budget);
}

}  // namespace standin
