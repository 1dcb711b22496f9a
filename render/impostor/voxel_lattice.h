// The recorded layers as a lattice of voxels, and what of it a depth mesh must show (thesis 4.3, math.md 3 and 7).
//
// Texel (x, y) of layer k is a voxel: the square of the texel, over the depth range of the layer. Of the opaque voxels only those that
// somebody in the view cell may see have to be shown. A ring about them is kept as well where a foreground hides a background that goes on
// behind it: simplification may move the border of either by about a texel, and no crack must open between them. Along a surface that
// merely bends away there is no such ring, since the surface itself closes the view.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/impostor/bit_image.h"
#include "render/impostor/impostor.h"

namespace standin {

struct VoxelLayer {
  BitImage opaque;  // as recorded
  BitImage solid;   // opaque, or hidden from the whole view cell by nearer layers
  BitImage wanted;  // opaque and to be shown
  BitImage joined;  // these, and hidden ones through which what is to be shown hangs together
  BitImage free;    // opaque, or hidden right beside opaque ones: where a mesh may lie
};

/// Layers near to far, all of one size; at least one.
struct VoxelLattice {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<VoxelLayer> layers;
};

/// Culls, and keeps a ring of up to `ring` voxels (in texels and layers).
[[nodiscard]] VoxelLattice voxel_lattice(std::vector<BitImage> opaque, int ring);
/// Every opaque voxel is to be shown, nothing is hidden.
[[nodiscard]] VoxelLattice unculled_lattice(std::vector<BitImage> opaque);

/// Depth as the simplification sees it: inverse depth, which perspective maps planes to planes in, scaled so that layers are about 1 apart
/// and growing with the distance. One entry a layer.
struct LatticeDepths {
  std::vector<double> plane;  // where the layer lies
  std::vector<double> near;   // the range it stands for
  std::vector<double> far;
  double scale = 0.0;    // of inverse metres
  double nearest = 0.0;  // inverse metres at 0

  [[nodiscard]] double of_metres(double depth_m) const { return scale * (nearest - 1.0 / depth_m); }
  /// 2 k: the plane of layer k, 2 k - 1: its near border.
  [[nodiscard]] double at(std::int32_t half_layers) const {
    const auto k = static_cast<std::size_t>(half_layers + 1) / 2;
    return half_layers % 2 == 0 ? plane[k] : near[k];
  }
};
/// The scaled inverse depth of the surface in voxel (x, y, layer); within the layer's range.
using SurfaceDepth = std::function<double(std::uint32_t x, std::uint32_t y, std::uint32_t layer)>;
[[nodiscard]] LatticeDepths lattice_depths(std::span<const Layer> layers);
/// Layer k at depth k, reaching half a layer to both sides.
[[nodiscard]] LatticeDepths uniform_depths(std::size_t layers);

}  // namespace standin
