// Textured depth meshes (thesis chapter 4): an impostor for scene parts near the view cell.
//
// Recorded like a layered impostor; but the layers' voxels are then connected to a mesh, the mesh is simplified as far as the voxels allow,
// and the result textured. So its size depends on the shape of the objects, not on the number of layers. A pure function like bake_layered.
#pragma once

#include "render/impostor/bake.h"
#include "render/impostor/impostor.h"

namespace standin {

struct DepthMeshQuality {
  double enlargement = 1.4;  // of voxels in the simplification, away from borders: 1 strict, up to 2 for fewer triangles
  int ring = 2;              // voxels kept beyond the borders of what can be seen
  double margin = 0.5;       // texels that borders are moved outwards after it
  double texels_per_voxel = 1.0;
};

struct DepthMeshSummary {
  std::uint32_t layers = 0;
  std::uint32_t meshes = 0;            // connected parts before simplification
  std::uint64_t initial_polygons = 0;  // quadrilaterals
  std::uint64_t triangles = 0;
  double record_s = 0.0;
  double mesh_s = 0.0;
  double simplify_s = 0.0;
  double texture_s = 0.0;
};

struct DepthMeshImpostor : Impostor {
  DepthMeshSummary summary;
};

/// Throws as bake_layered does. May return a mesh without triangles (nothing visible).
[[nodiscard]] DepthMeshImpostor bake_depth_mesh(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request,
                                                const Camera& camera, const BakeQuality& quality, const DepthMeshQuality& mesh_quality = {},
                                                const WorkBudget& budget = {});

}  // namespace standin
