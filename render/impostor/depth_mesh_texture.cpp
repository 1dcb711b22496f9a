#include "render/impostor/depth_mesh_texture.h"

#include <algorithm>
#include <cmath>

#include "render/impostor/border_margin.h"
#include "render/impostor/depth_mesh_charting.h"
#include "render/impostor/slab_piece.h"

namespace standin {
namespace {

/// A texel is filled where its centre is this near to a triangle: its square may meet the triangle (0.71), and one texel more.
constexpr double kReachTexels = 1.75;

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

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Barycentric coordinates of the triangle's point nearest to `point`.
Vec3 nearest_barycentric(const std::array<Vec2, 3>& t, const Vec2& point) {
  const double area = cross(t[1] - t[0], t[2] - t[0]);
  const Vec3 b(cross(t[1] - point, t[2] - point) / area, cross(t[2] - point, t[0] - point) / area,
               cross(t[0] - point, t[1] - point) / area);
  if (b.x >= 0.0 && b.y >= 0.0 && b.z >= 0.0) return b;
  Vec3 best(0.0);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec2 &from = t[static_cast<std::size_t>(i)], &to = t[static_cast<std::size_t>((i + 1) % 3)];
    const double share = std::clamp(glm::dot(point - from, to - from) / glm::dot(to - from, to - from), 0.0, 1.0);
    const Vec2 gap = from + share * (to - from) - point;
    if (const double distance2 = glm::dot(gap, gap); distance2 < least) {
      least = distance2;
      best = Vec3(0.0);
      best[i] = 1.0 - share;
      best[(i + 1) % 3] = share;
    }
  }
  return best;
}

/// The triangle's point that a texel shows.
struct TexelPlace {
  double distance2 = std::numeric_limits<double>::infinity();  // of the texel's centre, in texels
  Vec3 offset{0.0};
};

void place_texels(const ChartDraft& chart, const TriangleCorners& corners, std::span<const Vec3> offsets, std::vector<TexelPlace>& places) {
  const std::array<Vec2, 3> t{chart.texels[corners[0]], chart.texels[corners[1]], chart.texels[corners[2]]};
  const Vec2 low = glm::max(glm::floor(glm::min(t[0], glm::min(t[1], t[2])) - kReachTexels), Vec2(0.0));
  const Vec2 high = glm::min(glm::ceil(glm::max(t[0], glm::max(t[1], t[2])) + kReachTexels), Vec2(chart.width, chart.height));
  for (auto y = static_cast<std::uint32_t>(low.y); y < high.y; ++y)
    for (auto x = static_cast<std::uint32_t>(low.x); x < high.x; ++x) {
      const Vec2 centre(x + 0.5, y + 0.5);
      const Vec3 b = nearest_barycentric(t, centre);
      const Vec2 gap = b.x * t[0] + b.y * t[1] + b.z * t[2] - centre;
      TexelPlace& place = places[std::size_t{y} * chart.width + x];
      if (const double distance2 = glm::dot(gap, gap); distance2 < place.distance2)
        place = {distance2, b.x * offsets[corners[0]] + b.y * offsets[corners[1]] + b.z * offsets[corners[2]]};
    }
}

void append_chart(const ChartDraft& draft, const std::vector<Vec3>& offset_of_vertex, const VoxelColours& colours, TexturedMesh& mesh,
                  std::vector<std::uint8_t>& texels) {
  std::vector<Vec3> offsets;
  for (const std::uint32_t v : draft.vertices) offsets.push_back(offset_of_vertex[v]);
  mesh.charts.push_back({draft.width, draft.height, static_cast<std::uint32_t>(mesh.vertices.size()),
                         static_cast<std::uint32_t>(draft.vertices.size()), static_cast<std::uint32_t>(mesh.indices.size()),
                         static_cast<std::uint32_t>(3 * draft.triangles.size())});
  std::vector<TexelPlace> places(std::size_t{draft.width} * draft.height);
  for (const TriangleCorners& corners : draft.triangles) {
    place_texels(draft, corners, offsets, places);
    mesh.indices.insert(mesh.indices.end(), corners.begin(), corners.end());
  }
  for (std::size_t i = 0; i < offsets.size(); ++i) mesh.vertices.push_back({offsets[i], draft.texels[i]});
  for (const TexelPlace& place : places) {
    const bool filled = place.distance2 <= kReachTexels * kReachTexels;
    const auto rgba = filled ? colours.at(place.offset) : std::array<std::uint8_t, 4>{0, 0, 0, 0};
    texels.insert(texels.end(), rgba.begin(), rgba.end());
  }
}

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

TexturedMesh textured(const SimplifiedMesh& mesh, std::span<const LayerImage> images, const VoxelLattice& lattice,
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
    append_chart(draft, offsets, colours, result, texels);
  return result;
}

}  // namespace standin
