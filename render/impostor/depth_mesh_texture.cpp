#include "render/impostor/depth_mesh_texture.h"

#include <algorithm>
#include <cmath>

#include "render/impostor/border_margin.h"
#include "render/impostor/chart_texels.h"
#include "render/impostor/depth_mesh_charting.h"
#include "render/impostor/slab_piece.h"

namespace standin {
namespace {

struct Step {
  int x = 0, y = 0, layer = 0;
  [[nodiscard]] int length2() const { return x * x + y * y + layer * layer; }
};

/// Steps to voxels nearby, nearest first.
std::vector<Step> steps_within(int radius) {
  std::vector<Step> steps;
  for (int layer = -radius; layer <= radius; ++layer)
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) steps.push_back({x, y, layer});
  std::stable_sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.length2() < b.length2(); });
  return steps;
}

/// Colours of the recorded voxels, by points of the world.
class VoxelColours {
 public:
  VoxelColours(std::span<const LayerImage> images, const VoxelLattice& lattice, const ImpostorFrame& frame, std::span<const Layer> layers)
      : images_(images), lattice_(lattice), frame_(frame), layers_(layers), steps_(steps_within(4)) {}

  [[nodiscard]] std::array<std::uint8_t, 4> at(const Vec3& offset) const {
    const double depth = glm::dot(offset, frame_.forward);
    const Vec2 texel = texel_from_slope(frame_, Vec2(glm::dot(offset, frame_.right), glm::dot(offset, frame_.up)) / depth);
    const auto layer = std::partition_point(layers_.begin(), layers_.end() - 1, [&](const Layer& l) { return l.far_m < depth; });
    const Step from{static_cast<int>(std::floor(texel.x)), static_cast<int>(std::floor(texel.y)),
                    static_cast<int>(layer - layers_.begin())};
    for (const bool any_opaque : {false, true})
      for (const Step& step : steps_) {
        const Step to{from.x + step.x, from.y + step.y, from.layer + step.layer};
        if (has(to, any_opaque))
          return images_[static_cast<std::size_t>(to.layer)].get(static_cast<std::uint32_t>(to.x), static_cast<std::uint32_t>(to.y)).rgba;
      }
    return {128, 128, 128, 255};  // farther from any voxel than simplification can have gone
  }

 private:
  [[nodiscard]] bool has(const Step& v, bool any_opaque) const {
    if (v.x < 0 || v.y < 0 || v.layer < 0 || v.x >= static_cast<int>(lattice_.width) || v.y >= static_cast<int>(lattice_.height) ||
        v.layer >= static_cast<int>(lattice_.layers.size()))
      return false;
    const VoxelLayer& layer = lattice_.layers[static_cast<std::size_t>(v.layer)];
    return (any_opaque ? layer.opaque : layer.wanted).test(static_cast<std::uint32_t>(v.x), static_cast<std::uint32_t>(v.y));
  }

  std::span<const LayerImage> images_;
  const VoxelLattice& lattice_;
  const ImpostorFrame& frame_;
  std::span<const Layer> layers_;
  std::vector<Step> steps_;
};

/// Between layers' planes and borders, inverse distance is even; beyond the first and the last it goes on as it ends.
double distance_at(std::span<const Layer> layers, double half_layers) {
  const auto inverse = [&](int h) {
    const Layer& layer = layers[static_cast<std::size_t>(h + 1) / 2];
    return 1.0 / (h % 2 == 0 ? layer.distance_m : layer.near_m);
  };
  const int last = 2 * static_cast<int>(layers.size()) - 2;
  if (last == 0) return layers[0].distance_m;
  const int h = std::clamp(static_cast<int>(std::floor(half_layers)), 0, last - 1);
  const double share = half_layers - h;
  return 1.0 / (share == 0.0 ? inverse(h) : (1.0 - share) * inverse(h) + share * inverse(h + 1));
}

}  // namespace

TexturedMesh textured(const SimplifiedDepthMesh& mesh, std::span<const LayerImage> images, const VoxelLattice& lattice,
                      const ImpostorFrame& frame, std::span<const Layer> layers, const TextureOptions& options,
                      std::vector<std::uint8_t>& texels) {
  std::vector<Vec3> offsets;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 place = shifted_place(mesh, v);
    offsets.push_back(layer_point(frame, distance_at(layers, place.z), place.x, place.y) - frame.reference_viewpoint);
  }
  const VoxelColours colours(images, lattice, frame, layers);
  TexturedMesh result;
  for (const ChartDraft& draft : charts_of(mesh, options.texels_per_voxel, options.max_side))
    append_chart(
        draft, offsets, [&](const SurfaceSample& sample) { return colours.at(sample.offset); }, result, texels);
  return result;
}

}  // namespace standin
