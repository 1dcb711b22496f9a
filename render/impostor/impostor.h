// Impostors as they are drawn: textured triangles in the space of a reference viewpoint.
//
// An impostor stands for a set of objects, seen from anywhere in its view cell. Techniques differ in where its triangles lie: quads on
// layers (thesis chapter 3), a mesh through them (chapter 4), or a coarser mesh of the objects themselves (LOD-sprite). Whoever draws,
// packs, writes or measures takes textured_mesh(), which is the same for all. Its frame has the reference viewpoint as origin and looks
// along `forward` (= -axis of the shaft, or the box face's normal). A layer at distance A from the reference viewpoint is the rectangle { x
// : dot(x - P, forward) = A }, whose texel (i, j) of `resolution` spans slopes [lo + i * step, lo + (i+1) * step] along right and [.. j ..]
// along *down* (row 0 on top). Quads are rectangles of texels of one layer; opaque texels have alpha 255.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "render/scene/scene.h"
#include "render/view/camera.h"
#include "render/view/view_cell.h"

namespace standin {

/// Distances along `forward`, measured from the reference viewpoint (not from the near border, as math.md's t is).
struct Layer {
  double distance_m = 0.0;
  double near_m = 0.0;  // the depth range it stands for
  double far_m = 0.0;
};

/// Texels [x, x + width) x [y, y + height) of a layer.
struct Quad {
  std::uint32_t layer = 0;
  std::uint32_t x = 0, y = 0;
  std::uint32_t width = 0, height = 0;
};

struct ImpostorFrame {
  Vec3 reference_viewpoint{0.0};
  Vec3 forward{0.0, 0.0, -1.0};
  Vec3 right{1.0, 0.0, 0.0};
  Vec3 up{0.0, 1.0, 0.0};
  Vec2 slope_min{0.0};      // of texel column 0's left edge (along right) and of row 0's top edge (along up, the maximum: rows go down)
  Vec2 slope_step{0.0};     // > 0, per texel
  std::uint32_t width = 0;  // texels per layer
  std::uint32_t height = 0;
};

/// World position of the layer point at texel coordinates (x, y) (corners are integers).
[[nodiscard]] inline Vec3 layer_point(const ImpostorFrame& frame, double distance_m, double x, double y) {
  const double slope_right = frame.slope_min.x + x * frame.slope_step.x;
  const double slope_up = frame.slope_min.y - y * frame.slope_step.y;
  return frame.reference_viewpoint + distance_m * (frame.forward + slope_right * frame.right + slope_up * frame.up);
}

/// A corner of triangles: where it is, and what it shows.
struct ImpostorVertex {
  Vec3 offset{0.0};  // metres from the reference viewpoint, world axes
  Vec2 texel{0.0};   // in its chart's block, (0, 0) the upper left corner
};

/// A block of texels, one place in the atlas, and the triangles that show it.
struct Chart {
  std::uint32_t width = 0, height = 0;  // texels
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_index = 0, index_count = 0;  // 3 a triangle, counted from first_vertex
};

struct TexturedMesh {
  std::vector<Chart> charts;
  std::vector<ImpostorVertex> vertices;
  std::vector<std::uint32_t> indices;

  [[nodiscard]] std::size_t triangle_count() const { return indices.size() / 3; }
};

enum class Technique : std::uint8_t { kLayered, kDepthMesh, kPlanar, kLodSprite };
inline constexpr std::size_t kTechniqueCount = 4;
/// "layered", "tdm", "planar", "lod-sprite": as the command line and placement.json say.
[[nodiscard]] std::string_view technique_name(Technique technique);
[[nodiscard]] std::optional<Technique> technique_named(std::string_view name);
/// All names, in the order of the enumeration.
[[nodiscard]] std::span<const std::string_view> technique_names();
/// Whether its triangles are a mesh of their own; else they are quads on layers.
[[nodiscard]] constexpr bool is_mesh(Technique technique) {
  return technique == Technique::kDepthMesh || technique == Technique::kLodSprite;
}

/// One baked impostor. `texels` holds the RGBA8 blocks of its quads or charts one after the other, rows from the top, straight alpha (0 or
/// 255).
struct Impostor {
  std::vector<std::uint32_t> objects;  // ascending ids
  ViewCell view_cell;
  ImpostorFrame frame;
  std::vector<Layer> layers;
  std::vector<Quad> quads;  // unless is_mesh(technique): then `mesh`
  std::vector<std::uint8_t> texels;
  TexturedMesh mesh{};
  Technique technique = Technique::kLayered;
  bool fuzzy = false;  // outlines of its masked surfaces were left out: it may show gaps

  [[nodiscard]] std::uint64_t texel_count() const { return texels.size() / 4; }
  /// Shows nothing.
  [[nodiscard]] bool empty() const { return quads.empty() && mesh.charts.empty(); }
};

/// "nearest": gapless and free of parallax error at nearest-texel sampling; "none": fuzzy or a mesh, gapless and near the truth perhaps
/// (tests/bench/depth_mesh_table.md says how often).
[[nodiscard]] std::string_view guarantee_name(const Impostor& impostor);

/// One chart for each quad (corners from the upper left, counter-clockwise as the viewer sees them), or the mesh itself.
[[nodiscard]] TexturedMesh textured_mesh(const Impostor& impostor);

/// Where a quad's or chart's block lies in the atlas: texel (x, y) of page `page`; gutters are around it.
struct AtlasSlot {
  std::uint32_t page = 0;
  std::uint32_t x = 0, y = 0;
};

/// Impostors with their atlases: what the device draws and what the GLB holds.
struct ImpostorSet {
  std::vector<Impostor> impostors;
  std::vector<std::vector<AtlasSlot>> slots;  // slots[impostor][quad or chart]
  std::vector<Texture> pages;                 // colour dilated into transparent texels; masked at alpha 0.5
};

}  // namespace standin
