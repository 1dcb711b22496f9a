// A textured mesh as impostors hold it: vertices in the world, triangles in charts, one block of texels a chart.
#pragma once

#include <cstdint>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

struct ImpostorVertex {
  Vec3 offset{0.0};  // metres from the reference viewpoint, world axes
  Vec2 texel{0.0};   // in its chart's block, (0, 0) the upper left corner
};

/// A block of width x height texels, one place in the atlas, and the triangles it is on.
struct Chart {
  std::uint32_t width = 0, height = 0;
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_index = 0, index_count = 0;  // indices relative to first_vertex, 3 a triangle
};

struct TexturedMesh {
  std::vector<ImpostorVertex> vertices;
  std::vector<Chart> charts;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> texels;  // RGBA8, the charts' blocks one after the other, rows from the top, straight alpha (0 or 255)
};

}  // namespace standin
