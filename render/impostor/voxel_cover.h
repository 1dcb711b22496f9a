// How far a simplified mesh may stray: every voxel it stands for, enlarged by a factor, must still meet it, and its edges must stay within
// enlarged voxels that are opaque, or hidden beside opaque ones (thesis 4.5, math.md 7.4).
//
// We differ from the thesis: a voxel's box is not its layer's depth range but as far about the surface that was recorded in it. So the
// layer's range bounds how far the mesh may lie from the original, not twice that.
//
// All tests are made in (texel x, texel y, scaled inverse depth), where the triangles that are drawn in the world are plane too; so the
// bound holds for what is drawn and not only for the lattice. Boxes are closed.
#pragma once

#include <array>
#include <vector>

#include "render/impostor/voxel_lattice.h"

namespace standin {

struct Voxel {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t layer = 0;
  double depth = 0.0;  // of its surface, scaled inverse depth
};

/// A triangle with what its tests against boxes have in common.
struct CoverTriangle {
  CoverTriangle(const Vec3& a, const Vec3& b, const Vec3& c);

  std::array<Vec3, 3> corners;
  Vec3 normal{0.0};
  Vec3 low{0.0}, high{0.0};
};

class VoxelCover {
 public:
  /// Both must outlive this. `enlargement` >= 1 scales voxels' sides and depth ranges.
  VoxelCover(const VoxelLattice& lattice, const LatticeDepths& depths, double enlargement);

  [[nodiscard]] bool meets(const CoverTriangle& triangle, const Voxel& voxel) const;
  /// Whether every point of the segment lies in an enlarged free voxel.
  [[nodiscard]] bool covers(const Vec3& from, const Vec3& to) const;

 private:
  struct Span {
    double low = 0.0;
    double high = 0.0;
  };
  [[nodiscard]] double farthest_exit(const Vec3& from, const Vec3& to, double share) const;

  const VoxelLattice& lattice_;
  double half_side_;
  std::vector<Span> depth_;         // of the enlarged voxels of a layer, for segments
  std::vector<double> half_depth_;  // of a voxel's box about its surface
};

}  // namespace standin
