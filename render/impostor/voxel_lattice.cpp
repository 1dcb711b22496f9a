#include "render/impostor/voxel_lattice.h"

#include "render/impostor/culling.h"

namespace standin {
namespace {

/// Texels of which any of the 3 x 3 about them is set.
BitImage dilated(const BitImage& image) {
  BitImage wide = image;
  const std::size_t words = image.words_per_row();
  const std::uint64_t last_word = image.width() % 64 == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << image.width() % 64) - 1;
  for (std::uint32_t y = 0; y < image.height(); ++y) {
    const std::uint64_t* in = image.row(y);
    std::uint64_t* out = wide.row(y);
    for (std::size_t i = 0; i < words; ++i)
      out[i] |= in[i] << 1 | (i > 0 ? in[i - 1] >> 63 : 0) | in[i] >> 1 | (i + 1 < words ? in[i + 1] << 63 : 0);
    out[words - 1] &= last_word;
  }
  BitImage result = wide;
  for (std::uint32_t y = 0; y < image.height(); ++y)
    for (std::size_t i = 0; i < words; ++i) {
      if (y > 0) result.row(y)[i] |= wide.row(y - 1)[i];
      if (y + 1 < image.height()) result.row(y)[i] |= wide.row(y + 1)[i];
    }
  return result;
}

/// One step of growth into opaque neighbours, among them those of the next and the previous layer. What lies right behind something seen,
/// or hidden right before it, is left out: that is the inside of a surface, not a background.
void grow_wanted(VoxelLattice& lattice, const std::vector<BitImage>& inside) {
  std::vector<BitImage> wide;
  for (const VoxelLayer& layer : lattice.layers) wide.push_back(dilated(layer.wanted));
  for (std::size_t k = 0; k < wide.size(); ++k) {
    BitImage grown = wide[k];
    if (k > 0) grown |= wide[k - 1];
    if (k + 1 < wide.size()) grown |= wide[k + 1];
    grown &= lattice.layers[k].opaque;
    grown -= inside[k];
    lattice.layers[k].wanted |= grown;
  }
}

/// Opaque voxels between seen ones of the layers before and behind. Where a surface recedes under itself, rays at the limit of their shift
/// just miss them, but its steps hang together through them.
void find_bridges(VoxelLattice& lattice) {
  for (std::size_t k = 0; k < lattice.layers.size(); ++k) {
    VoxelLayer& layer = lattice.layers[k];
    if (k > 0 && k + 1 < lattice.layers.size()) {
      layer.joined = dilated(lattice.layers[k - 1].wanted);
      layer.joined &= dilated(lattice.layers[k + 1].wanted);
      layer.joined &= layer.opaque;
    }
    layer.joined |= layer.wanted;
  }
}

VoxelLattice sized_like(const std::vector<BitImage>& opaque) {
  return {opaque.front().width(), opaque.front().height(), {}};
}

}  // namespace

VoxelLattice voxel_lattice(std::vector<BitImage> opaque, int ring) {
  VoxelLattice lattice = sized_like(opaque);
  OcclusionCulling culling(lattice.width, lattice.height, CullRule::kCorner);
  std::vector<BitImage> inside{BitImage(lattice.width, lattice.height)};
  for (BitImage& mask : opaque) {
    BitImage solid = culling.hidden(), wanted = mask;
    wanted -= culling.hidden_in_next(mask);
    solid |= mask;
    inside.push_back(dilated(wanted));
    const BitImage none(lattice.width, lattice.height);
    lattice.layers.push_back({std::move(mask), std::move(solid), std::move(wanted), none, none});
  }
  find_bridges(lattice);
  for (std::size_t k = 0; k + 1 < lattice.layers.size(); ++k) inside[k] |= lattice.layers[k + 1].joined;
  for (int i = 0; i < ring; ++i) grow_wanted(lattice, inside);
  for (VoxelLayer& layer : lattice.layers) {
    layer.joined |= layer.wanted;
    layer.free = dilated(layer.opaque);
    layer.free &= layer.solid;
  }
  return lattice;
}

VoxelLattice unculled_lattice(std::vector<BitImage> opaque) {
  VoxelLattice lattice = sized_like(opaque);
  for (const BitImage& mask : opaque) lattice.layers.push_back({mask, mask, mask, mask, mask});
  return lattice;
}

LatticeDepths lattice_depths(std::span<const Layer> layers) {
  const double first = 1.0 / layers.front().distance_m, last = 1.0 / layers.back().distance_m;
  const double nearest = 1.0 / layers.front().near_m, farthest = 1.0 / layers.back().far_m;
  const double range = layers.size() > 1 ? first - last : nearest - farthest;
  const double scale = range > 0.0 ? static_cast<double>(std::max<std::size_t>(layers.size() - 1, 1)) / range : 1.0;
  LatticeDepths depths;
  depths.scale = scale;
  depths.nearest = first;
  for (const Layer& layer : layers) {
    depths.plane.push_back(depths.of_metres(layer.distance_m));
    depths.near.push_back(depths.of_metres(layer.near_m));
    depths.far.push_back(depths.of_metres(layer.far_m));
  }
  if (range <= 0.0) depths.near[0] = -0.5, depths.far[0] = 0.5;  // a plane facing the viewer
  return depths;
}

LatticeDepths uniform_depths(std::size_t layers) {
  LatticeDepths depths;
  for (std::size_t k = 0; k < layers; ++k) {
    const auto plane = static_cast<double>(k);
    depths.plane.push_back(plane);
    depths.near.push_back(plane - 0.5);
    depths.far.push_back(plane + 0.5);
  }
  return depths;
}

}  // namespace standin
