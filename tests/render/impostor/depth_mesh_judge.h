// The promise of a depth mesh, judged by rays alone: the original triangles on one side, the mesh's triangles in the world on the other.
// Shares no code with the baker. Definitions as in ray_judge.h; the depth range of a shown point is that of the layer it lies in.
#pragma once

#include "render/impostor/bake_depth_mesh.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin::test {

/// The mesh as surfaces in the world.
[[nodiscard]] inline std::vector<Surface> surfaces_of(const DepthMeshImpostor& impostor) {
  std::vector<Surface> surfaces;
  const TexturedMesh& mesh = impostor.mesh;
  for (const Chart& chart : mesh.charts)
    for (std::uint32_t i = 0; i < chart.index_count; i += 3) {
      Surface surface;
      for (std::uint32_t k = 0; k < 3; ++k)
        surface.corners[k] =
            impostor.frame.reference_viewpoint + mesh.vertices[chart.first_vertex + mesh.indices[chart.first_index + i + k]].offset;
      surfaces.push_back(surface);
    }
  return surfaces;
}

[[nodiscard]] inline std::size_t layer_at(const DepthMeshImpostor& impostor, double depth_m) {
  std::size_t layer = 0;
  while (layer + 1 < impostor.layers.size() && impostor.layers[layer].far_m < depth_m) ++layer;
  return layer;
}

/// The original's point on the reference ray through `shown` that is nearest in depth, if it lies in the layer of `shown` or the next.
[[nodiscard]] inline std::optional<Vec3> original_of(const std::vector<Surface>& original, const DepthMeshImpostor& impostor,
                                                     const Vec3& shown) {
  const ImpostorFrame& f = impostor.frame;
  const double depth = glm::dot(shown - f.reference_viewpoint, f.forward);
  const Vec3 per_depth = (shown - f.reference_viewpoint) / depth;
  const std::size_t layer = layer_at(impostor, depth);
  const double near_m = impostor.layers[layer > 0 ? layer - 1 : 0].near_m;
  const double far_m = impostor.layers[std::min(layer + 1, impostor.layers.size() - 1)].far_m;
  std::optional<double> best;
  for (const Surface& surface : original) {
    const auto at = hit(surface, f.reference_viewpoint, per_depth);
    if (at && *at >= near_m - 1e-9 && *at <= far_m + 1e-9 && (!best || std::abs(*at - depth) < std::abs(*best - depth))) best = at;
  }
  if (!best) return std::nullopt;
  return f.reference_viewpoint + *best * per_depth;
}

struct MeshVerdict : Verdict {
  std::vector<double> parallax;  // over alpha, of every judged pixel
};

inline void judge_mesh_pixel(const std::vector<Surface>& original, const std::vector<Surface>& drawn, const DepthMeshImpostor& impostor,
                             const Vec3& viewpoint, const Vec3& direction, double pixel_rad, MeshVerdict& verdict) {
  const Vec3 d = glm::normalize(direction);
  const Vec3 side = glm::normalize(glm::cross(d, std::abs(d.y) < 0.9 ? Vec3(0, 1, 0) : Vec3(1, 0, 0))), other = glm::cross(side, d);
  double farthest = 0.0;
  for (const double radius : {0.0, 0.5, 1.0, 1.5, 2.0})
    for (int i = 0; i < (radius == 0.0 ? 1 : 16); ++i) {
      const double angle = i * 0.39269908169872414, r = radius * pixel_rad;
      const auto distance = first_hit(original, viewpoint, d + r * (std::cos(angle) * side + std::sin(angle) * other));
      if (!distance) return;
      farthest = std::max(farthest, *distance);
    }
  ++verdict.judged;
  const auto shown = first_hit(drawn, viewpoint, d);
  if (!shown) {
    ++verdict.gaps;
    return;
  }
  const ImpostorFrame& f = impostor.frame;
  const Vec3 point = viewpoint + *shown * d;
  const Layer& layer = impostor.layers[layer_at(impostor, glm::dot(point - f.reference_viewpoint, f.forward))];
  if (*shown > farthest + (layer.far_m - layer.near_m) / glm::dot(d, f.forward) + 1e-9) ++verdict.gaps;
  if (const auto x = original_of(original, impostor, point)) {
    const Vec3 a = *x - viewpoint, b = point - viewpoint;
    verdict.parallax.push_back(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / pixel_rad);
    verdict.worst_parallax = std::max(verdict.worst_parallax, verdict.parallax.back());
    ++verdict.parallax_judged;
  }
}

/// Rays from all over the view cell to random points of the original.
[[nodiscard]] inline MeshVerdict judge_mesh(const std::vector<Surface>& original, const DepthMeshImpostor& impostor, double pixel_rad,
                                            int rays, std::uint64_t seed) {
  const std::vector<Surface> drawn = surfaces_of(impostor);
  MeshVerdict verdict;
  for_each_random_ray(original, impostor.view_cell, rays, Rng(seed, 78), [&](const Vec3& viewpoint, const Vec3& direction) {
    judge_mesh_pixel(original, drawn, impostor, viewpoint, direction, pixel_rad, verdict);
  });
  return verdict;
}

}  // namespace standin::test
