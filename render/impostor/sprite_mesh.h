// The coarse mesh of a LOD-sprite: as few triangles as the error criterion allows.
//
// The cluster's surfaces are welded to one mesh. Vertices are clustered first (meshoptimizer), without regard to topology and within a
// quarter of what the criterion allows, so that the many loose parts of a model grow together; then edges are contracted as far as it
// allows (sprite_contraction.h). Judged are all original vertices and triangle centres.
#pragma once

#include "render/base/work.h"
#include "render/impostor/cluster_surface.h"
#include "render/impostor/triangle_complex.h"

namespace standin {

struct SpriteMesh {
  std::vector<Vec3> vertices;  // from the reference viewpoint; each of them one of the original's
  std::vector<TriangleCorners> triangles;
};

[[nodiscard]] std::vector<std::array<Vec3, 3>> corners_of(const SpriteMesh& mesh);

/// `alpha_rad` is the criterion's eps * delta; `nearest_m` the least distance of the surface from the view cell, where the search starts.
[[nodiscard]] SpriteMesh sprite_mesh(const std::vector<SurfaceTriangle>& surface, const Vec3& forward, std::span<const Vec3> viewpoints,
                                     double alpha_rad, double nearest_m, const WorkBudget& budget = {});

}  // namespace standin
