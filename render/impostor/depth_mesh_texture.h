// Textures for a simplified depth mesh (thesis 4.6), in object space.
//
// Triangles that face the same axis of the lattice share a chart: texture coordinates are the lattice's other two, so neighbours agree
// along their edges and one texel is one voxel. The thesis projects the recorded image and asks for perspective correction to be switched
// off; here coordinates are affine on each triangle as it lies in the world, so any viewer that interpolates correctly shows it right. The
// colour of a texel is that of the recorded voxel nearest to the point of the triangle it stands for.
#pragma once

#include <span>

#include "render/impostor/depth_mesh_simplify.h"
#include "render/impostor/impostor.h"
#include "render/impostor/layer_image.h"

namespace standin {

struct TextureOptions {
  double texels_per_voxel = 1.0;
  std::uint32_t max_side = 2048;  // of a chart, texels
};

/// Appends the charts' blocks to `texels`. `images` are the recorded layers that `lattice` came from; of near voxels those that can be seen
/// are preferred.
[[nodiscard]] TexturedMesh textured(const SimplifiedDepthMesh& mesh, std::span<const LayerImage> images, const VoxelLattice& lattice,
                                    const ImpostorFrame& frame, std::span<const Layer> layers, const TextureOptions& options,
                                    std::vector<std::uint8_t>& texels);

}  // namespace standin
