#include "render/impostor/bake_depth_mesh.h"

#include <chrono>

#include "render/impostor/border_margin.h"
#include "render/impostor/depth_mesh_texture.h"
#include "render/impostor/recorder.h"
#include "render/impostor/recording.h"

namespace standin {
namespace {

/// Runs a step and notes how long it took; the time is for the report alone.
template <class Work>
auto timed(double& seconds, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

VoxelLattice lattice_of(const std::vector<LayerImage>& images, int ring) {
  std::vector<BitImage> opaque;
  for (const LayerImage& image : images) opaque.push_back(opaque_texels(image));
  return voxel_lattice(std::move(opaque), ring);
}

/// A mesh has a ring of its own.
BakeQuality unsealed(BakeQuality quality) {
  quality.seal_rims = false;
  return quality;
}

}  // namespace

DepthMeshImpostor bake_depth_mesh(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                                  const BakeQuality& quality, const DepthMeshQuality& mesh_quality, const WorkBudget& budget) {
  DepthMeshSummary summary;
  const Recording recording =
      timed(summary.record_s, [&] { return record_request(scene, textures, request, camera, unsealed(quality), budget); });
  VoxelLattice lattice;
  const DepthMesh initial = timed(summary.mesh_s, [&] {
    lattice = lattice_of(recording.images, mesh_quality.ring);
    return initial_depth_mesh(lattice, Sheets::kSeen);
  });
  const SimplifiedDepthMesh simplified = timed(summary.simplify_s, [&] {
    const LatticeDepths depths = lattice_depths(recording.layers);
    const auto surface_depth = [&](std::uint32_t x, std::uint32_t y, std::uint32_t layer) {
      return depths.of_metres(depth_m(recording.images[layer].get(x, y), recording.layers[layer]));
    };
    SimplifiedDepthMesh mesh = simplify(initial, lattice, depths, surface_depth, mesh_quality.enlargement, budget);
    widen_borders(mesh, mesh_quality.margin);
    return mesh;
  });
  Impostor impostor{request.objects, request.view_cell, recording.frame, recording.layers, {}, {}, {}, Technique::kDepthMesh};
  impostor.fuzzy = recording.fuzzy;
  impostor.mesh = timed(summary.texture_s, [&] {
    return textured(simplified, recording.images, lattice, recording.frame, recording.layers,
                    {.texels_per_voxel = mesh_quality.texels_per_voxel}, impostor.texels);
  });
  summary.layers = static_cast<std::uint32_t>(recording.layers.size());
  summary.meshes = initial.meshes;
  summary.initial_polygons = initial.flats + initial.walls;
  summary.triangles = simplified.triangles.size();
  return {{std::move(impostor)}, summary};
}

}  // namespace standin
