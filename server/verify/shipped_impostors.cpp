#include "server/verify/shipped_impostors.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kTexelTolerance = 0.02;  // float corners lie within 1e-3 texels of their place
constexpr double kDepthTolerance = 1e-5;  // of the layer's distance
constexpr std::size_t kTrianglesPerQuad = 2;

[[noreturn]] void broken(const std::string& impostor, const std::string& what) {
  throw Failure(ErrorWord::kFileBroken, "impostors.glb: " + impostor + " " + what);
}

/// A corner of a quad, in texels of its layer and of its atlas page.
struct Corner {
  std::uint32_t layer = 0;
  std::int64_t x = 0, y = 0;
  std::int64_t page_x = 0, page_y = 0;
};

struct QuadInAtlas {
  Quad quad;
  AtlasSlot slot;
};

class ImpostorReader {
 public:
  ImpostorReader(const PlacementImpostor& placed, const GlbImpostor& shipped, const std::vector<GlbPage>& pages)
      : placed_(placed), shipped_(shipped), pages_(pages) {}

  void read(Impostor& impostor, std::vector<AtlasSlot>& slots) const;

 private:
  [[nodiscard]] std::int64_t texel(double coordinate) const;
  [[nodiscard]] std::uint32_t layer_at(double depth_m) const;
  [[nodiscard]] Corner corner(const GlbTriangle& triangle, std::size_t vertex) const;
  [[nodiscard]] QuadInAtlas quad(const GlbTriangle* triangles) const;
  void copy_texels(const QuadInAtlas& quad, std::vector<std::uint8_t>& texels) const;
  void read_quads(Impostor& impostor, std::vector<AtlasSlot>& slots) const;
  void read_mesh(Impostor& impostor, std::vector<AtlasSlot>& slots) const;

  const PlacementImpostor& placed_;
  const GlbImpostor& shipped_;
  const std::vector<GlbPage>& pages_;
};

std::int64_t ImpostorReader::texel(double coordinate) const {
  const double rounded = std::round(coordinate);
  if (!(std::abs(coordinate - rounded) <= kTexelTolerance))
    broken(shipped_.node, "has a corner at texel coordinate " + std::to_string(coordinate) + ", which is no texel's corner");
  return static_cast<std::int64_t>(rounded);
}

std::uint32_t ImpostorReader::layer_at(double depth_m) const {
  const auto& layers = placed_.layers;
  const auto nearest = std::min_element(layers.begin(), layers.end(), [&](const Layer& a, const Layer& b) {
    return std::abs(a.distance_m - depth_m) < std::abs(b.distance_m - depth_m);
  });
  if (nearest == layers.end() || !(std::abs(nearest->distance_m - depth_m) <= kDepthTolerance * depth_m))
    broken(shipped_.node, "has a corner " + std::to_string(depth_m) + " m before its reference viewpoint, where no layer is");
  return static_cast<std::uint32_t>(nearest - layers.begin());
}

Corner ImpostorReader::corner(const GlbTriangle& triangle, std::size_t vertex) const {
  const ImpostorFrame& frame = placed_.frame;
  const Vec3 offset = shipped_.origin + triangle.offsets[vertex] - frame.reference_viewpoint;
  const double depth_m = glm::dot(offset, frame.forward);
  Corner result;
  result.layer = layer_at(depth_m);
  result.x = texel((glm::dot(offset, frame.right) / depth_m - frame.slope_min.x) / frame.slope_step.x);
  result.y = texel((frame.slope_min.y - glm::dot(offset, frame.up) / depth_m) / frame.slope_step.y);
  result.page_x = texel(triangle.texels[vertex].x);
  result.page_y = texel(triangle.texels[vertex].y);
  return result;
}

/// Two triangles: all corners on one layer, and atlas and layer texels of one scale and orientation.
QuadInAtlas ImpostorReader::quad(const GlbTriangle* triangles) const {
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < 3 * kTrianglesPerQuad; ++i) corners.push_back(corner(triangles[i / 3], i % 3));
  Corner low = corners[0], high = corners[0];
  for (const Corner& c : corners) {
    low = {low.layer, std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.page_x, c.page_x), std::min(low.page_y, c.page_y)};
    high = {low.layer, std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.page_x, c.page_x), std::max(high.page_y, c.page_y)};
  }
  if (triangles[0].page != triangles[1].page) broken(shipped_.node, "has a quad on two atlas pages");
  for (const Corner& c : corners)
    if (c.layer != low.layer || c.x - low.x != c.page_x - low.page_x || c.y - low.y != c.page_y - low.page_y)
      broken(shipped_.node, "has a quad whose texels in the atlas are not those of its layer");
  const GlbPage& page = pages_[triangles[0].page];
  if (low.x < 0 || low.y < 0 || high.x > placed_.frame.width || high.y > placed_.frame.height || low.page_x < 0 || low.page_y < 0 ||
      high.page_x > page.width || high.page_y > page.height || low.x == high.x || low.y == high.y)
    broken(shipped_.node, "has a quad that is empty or lies outside its layer or its atlas page");
  const auto u32 = [](std::int64_t value) { return static_cast<std::uint32_t>(value); };
  return {{low.layer, u32(low.x), u32(low.y), u32(high.x - low.x), u32(high.y - low.y)},
          {triangles[0].page, u32(low.page_x), u32(low.page_y)}};
}

void ImpostorReader::copy_texels(const QuadInAtlas& block, std::vector<std::uint8_t>& texels) const {
  const GlbPage& page = pages_[block.slot.page];
  for (std::uint32_t row = 0; row < block.quad.height; ++row) {
    const std::size_t first = 4 * ((block.slot.y + row) * static_cast<std::size_t>(page.width) + block.slot.x);
    const auto begin = page.rgba.begin() + static_cast<std::ptrdiff_t>(first);
    texels.insert(texels.end(), begin, begin + static_cast<std::ptrdiff_t>(4 * block.quad.width));
  }
}

/// A chart for each page, the whole of it.
void ImpostorReader::read_mesh(Impostor& impostor, std::vector<AtlasSlot>& slots) const {
  std::map<std::uint32_t, std::vector<const GlbTriangle*>> by_page;
  for (const GlbTriangle& triangle : shipped_.triangles) by_page[triangle.page].push_back(&triangle);
  TexturedMesh& mesh = impostor.mesh;
  for (const auto& [page, triangles] : by_page) {
    const auto count = static_cast<std::uint32_t>(3 * triangles.size());
    mesh.charts.push_back({static_cast<std::uint32_t>(pages_[page].width), static_cast<std::uint32_t>(pages_[page].height),
                           static_cast<std::uint32_t>(mesh.vertices.size()), count, static_cast<std::uint32_t>(mesh.indices.size()),
                           count});
    for (std::uint32_t i = 0; i < count; ++i) {
      const GlbTriangle& triangle = *triangles[i / 3];
      mesh.vertices.push_back(
          {shipped_.origin + triangle.offsets.at(i % 3) - placed_.frame.reference_viewpoint, triangle.texels.at(i % 3)});
      mesh.indices.push_back(i);
    }
    slots.push_back({page, 0, 0});
  }
}

void ImpostorReader::read_quads(Impostor& impostor, std::vector<AtlasSlot>& slots) const {
  for (std::size_t i = 0; i < shipped_.triangles.size(); i += kTrianglesPerQuad) {
    const QuadInAtlas block = quad(&shipped_.triangles[i]);
    impostor.quads.push_back(block.quad);
    slots.push_back(block.slot);
    copy_texels(block, impostor.texels);
  }
}

void ImpostorReader::read(Impostor& impostor, std::vector<AtlasSlot>& slots) const {
  const bool layered = !is_mesh(impostor.technique);
  if ((shipped_.triangles.size() + (layered ? 0 : 1)) / kTrianglesPerQuad != placed_.quads ||
      (layered && shipped_.triangles.size() % kTrianglesPerQuad != 0))
    broken(shipped_.node, "has " + std::to_string(shipped_.triangles.size()) + " triangles; the placement says " +
                              std::to_string(placed_.quads) + " quads");
  if (layered)
    read_quads(impostor, slots);
  else
    read_mesh(impostor, slots);
}

}  // namespace

ImpostorSet shipped_impostors(const GlbQuads& glb, const Placement& placement) {
  std::map<std::string, const GlbImpostor*> shipped_as;
  for (const auto& impostor : glb.impostors) shipped_as.emplace(impostor.node, &impostor);
  ImpostorSet set;
  for (std::size_t id = 0; id < placement.impostors.size(); ++id) {
    const PlacementImpostor& placed = placement.impostors[id];
    const std::string node = "imp_" + std::to_string(id);
    const auto found = shipped_as.find(node);
    if (found == shipped_as.end()) broken(node, "is in the placement but not in the file");
    const auto technique = technique_named(placed.technique);
    if (!technique) broken(node, "is made by the technique \"" + placed.technique + "\", which is not known");
    set.impostors.push_back({placed.objects, placed.view_cell, placed.frame, placed.layers, {}, {}, {}, *technique});
    ImpostorReader(placed, *found->second, glb.pages).read(set.impostors.back(), set.slots.emplace_back());
  }
  for (const auto& page : glb.pages) set.pages.push_back({"atlas_" + std::to_string(set.pages.size()), page.width, page.height, page.rgba});
  return set;
}

ImpostorSet read_shipped_impostors(const std::string& glb, const Placement& placement) {
  return shipped_impostors(read_glb_quads(glb), placement);
}

}  // namespace standin
