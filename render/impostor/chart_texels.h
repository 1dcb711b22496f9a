// Charts with their texels: for each texel of a chart the point of the mesh that it stands for, and that point's colour (thesis 4.6).
//
// Texture coordinates are affine on each triangle as it lies in the world, so any viewer that interpolates correctly shows it right,
// whatever the projection the colours come from. Texels a little beyond a triangle are filled as well, for filtering.
#pragma once

#include <functional>
#include <span>

#include "render/impostor/depth_mesh_charting.h"

namespace standin {

/// A point of a textured triangle.
struct SurfaceSample {
  Vec3 offset{0.0};  // from the reference viewpoint
  Vec3 normal{0.0};  // of the triangle, unit; 0 where it has no area
};
using SampleColour = std::function<std::array<std::uint8_t, 4>(const SurfaceSample&)>;

/// Appends the chart to `mesh` and its block to `texels`. `offset_of_vertex` are those of the mesh that was charted.
void append_chart(const ChartDraft& draft, std::span<const Vec3> offset_of_vertex, const SampleColour& colour, TexturedMesh& mesh,
                  std::vector<std::uint8_t>& texels);

}  // namespace standin
