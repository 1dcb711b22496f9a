// Which triangles of a depth mesh share a block of texels, and where they lie in it (see depth_mesh_texture.h).
#pragma once

#include "render/impostor/depth_mesh_simplify.h"
#include "render/impostor/impostor.h"

namespace standin {

/// One chart before it has colours. `texels` are in its block, one entry a vertex.
struct ChartDraft {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> vertices;  // of the mesh
  std::vector<Vec2> texels;
  std::vector<TriangleCorners> triangles;  // indices into `vertices`
};

/// Every triangle is in one chart. Charts grow over edges as long as that saves texels; no texel centre is in two triangles
/// of one.
[[nodiscard]] std::vector<ChartDraft> charts_of(const SimplifiedDepthMesh& mesh, double texels_per_voxel, std::uint32_t max_side);

}  // namespace standin
