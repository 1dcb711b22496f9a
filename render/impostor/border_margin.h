// Gives a depth mesh back the margin that its borders have lost (thesis 4.4 leaves it away, "slightly smaller than the voxels").
//
// The initial mesh ends a quarter texel within the outermost voxels, and simplification may take up to a texel more where a border is
// jagged. Seen at the limit of the view cell, rays slip through between such a border and a background that is not there, since nobody was
// to see it. So border vertices are moved outwards, in the planes of their triangles.
#pragma once

#include "render/impostor/depth_mesh_simplify.h"

namespace standin {

/// Sets `shifts`, so that border edges lie `margin` (texels and layers) farther out; at sharp corners vertices move by twice that at most.
void widen_borders(SimplifiedDepthMesh& mesh, double margin);

/// Where a vertex lies: texel coordinates, and depth in half layers.
[[nodiscard]] inline Vec3 shifted_place(const SimplifiedDepthMesh& mesh, std::uint32_t v) {
  const Vec3 place(texel_coordinates(mesh.vertices[v]), mesh.vertices[v].depth);
  return mesh.shifts.empty() ? place : place + mesh.shifts[v];
}

}  // namespace standin
