// The initial mesh over a lattice of voxels (thesis 4.4), complete and yet without useless sheets.
//
// Between the voxels lie cells on a lattice twice as fine: one for each voxel, for each pair side by side or one above the other, and for
// each block of 2 x 2; a cell is opaque where all its voxels are. Four vertices a voxel, a quarter texel from its centre, are the corners
// of all these cells. The thesis' twelve rules leak where a ray passes under a cell of the nearer layer; we use a complete rule instead
// (math.md 7.3): with X_k the cells opaque in layers k-1 and k,
//     a flat polygon in layer k for each opaque cell outside X_k,
//     a wall between layers k-1 and k on each edge from a cell of X_k to one outside.
// A ray that reaches an opaque cell of layer k either meets its flat polygon or has been in X_k since layer k-1 or came in through a wall.
//
// Of these, `Sheets::kSeen` leaves out what the view cell cannot see: flats of hidden voxels, and walls whose other side is solid (opaque
// or hidden), the backs of surfaces. It adds flats that face away from the viewer where a surface recedes under itself, so that its steps
// hang together and can be simplified as one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/impostor/voxel_lattice.h"

namespace standin {

/// At texel coordinates (x / 2 + 1/4, y / 2 + 1/4); depth 2 k is the plane of layer k, 2 k - 1 the border of the layers k - 1 and k.
/// Integers, in half texels and half layers, so that lengths and their ties are exact.
struct LatticeVertex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t depth = 0;
  friend bool operator==(const LatticeVertex&, const LatticeVertex&) = default;
};

[[nodiscard]] inline Vec2 texel_coordinates(const LatticeVertex& v) {
  return {0.5 * v.x + 0.25, 0.5 * v.y + 0.25};
}

/// A quadrilateral, and the cell whose voxels of `layer` it stands for. Cell (x, y) spans vertices (x, y) to (x + 1, y + 1) and has the
/// voxels x / 2 to (x + 1) / 2, likewise in y. A wall is two such, on either side of the layers' border: on a slope the surface passes
/// there, half way between the corners of its steps, and simplification may put vertices there.
struct DepthPolygon {
  std::array<std::uint32_t, 4> corners{0, 0, 0, 0};
  std::int32_t cell_x = 0;
  std::int32_t cell_y = 0;
  std::int32_t layer = 0;
};

struct DepthMesh {
  std::vector<LatticeVertex> vertices;
  std::vector<DepthPolygon> polygons;  // by layer, then by row
  std::uint64_t flats = 0;
  std::uint64_t walls = 0;
  std::uint32_t meshes = 0;  // connected parts
};

enum class Sheets { kAll, kSeen };

[[nodiscard]] DepthMesh initial_depth_mesh(const VoxelLattice& lattice, Sheets sheets);

}  // namespace standin
