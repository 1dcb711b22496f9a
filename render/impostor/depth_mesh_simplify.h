// From the initial depth mesh to few triangles that still cover its voxels (thesis 4.5, in the precise form of math.md 7.4).
//
// First, what is exactly flat: a vertex whose removal changes no point of the surface goes, without a question to the voxels. Then edges
// are contracted, shortest first, ties by the ends' ids. One end v is taken into the other if
//   - v is inside the mesh, or both lie on a border edge (borders do not branch), and manifold edges stay manifold; a hole whose last
//     three edges remain closes;
//   - no triangle turns over;
//   - every voxel that a triangle of v stood for, enlarged, meets one of the new triangles;
//   - every new edge lies in enlarged voxels that are opaque, or hidden beside opaque ones, so that nothing new covers what was open.
// Else the other end is tried; else the edge waits until a neighbouring one has been contracted. We differ from the thesis: each voxel
// belongs to one triangle that meets it, which keeps all voxels covered at less cost, and inner edges are held to the voxels as well.
#pragma once

#include "render/base/work.h"
#include "render/impostor/triangle_complex.h"

namespace standin {

struct SimplifiedDepthMesh {
  std::vector<LatticeVertex> vertices;
  std::vector<Vec3> shifts;  // of vertices from their places: texels, texels, half layers; empty: none (see border_margin.h)
  std::vector<TriangleCorners> triangles;
};

/// `enlargement` in [1, 2] of the voxels; `surface_depth` says where in its layer a voxel's surface lies. Order, and so the result, depends
/// on the arguments alone.
[[nodiscard]] SimplifiedDepthMesh simplify(const DepthMesh& mesh, const VoxelLattice& lattice, const LatticeDepths& depths,
                                           const SurfaceDepth& surface_depth, double enlargement, const WorkBudget& budget = {});

}  // namespace standin
