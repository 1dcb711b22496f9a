// A proven lower bound on the bytes of an impostor that was not baked: the certificate beside a placement rests on it.
//
// Seen from the reference viewpoint, call a texel's pyramid through all layers its column. Every surface that is drawn opaque makes texels
// opaque in some layer of each column it touches: the layers' slabs follow each other without a gap, coverage is closed. The nearest opaque
// texel of a column is never culled, since both culling rules ask for an opaque texel before it at its own place. And every texel that is
// left lies in a quad. So an impostor has at least as many texels as columns are touched, whatever its layers are, and its quads span at
// least as many columns of texels, and rows, as are touched:
//
//     bytes >= 4 (sum of w h + 2 g (w + h) + 4 g^2)  >=  4 (T + 2 g (T_x + T_y) + 4 g^2)      g: gutter; one quad at least
//
// A region of area a touches at least a texels wherever the texture's grid lies, so T, T_x, T_y are bounded by areas and lengths: of large
// faces that do not overlap in projection, and of connected pieces. The bake fits texels to all vertices, the bound to a few of them. That
// is on the safe side: the nearest of a few vertices is no nearer, and texels grow with its distance. Masked surfaces prove nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/impostor/bake.h"

namespace standin {

class SizeBound {
 public:
  /// Finds each mesh's large faces and connected pieces. Keeps a reference to the scene.
  explicit SizeBound(const Scene& scene);

  /// <= texture_bytes() of bake_layered's impostor, where one is possible; 0 where nothing is proven to be seen. Any thread.
  [[nodiscard]] double texture_bytes(std::span<const std::uint32_t> objects, const ViewCell& cell, const Camera& camera,
                                     const BakeQuality& quality) const;

  /// A triangle, or two that share the diagonal 0-2.
  struct Face {
    std::array<Vec3, 4> corners{Vec3(0.0), Vec3(0.0), Vec3(0.0), Vec3(0.0)};
    std::size_t count = 3;
  };
  /// In mesh space.
  struct MeshShape {
    std::vector<Face> faces;                // the largest, largest first
    std::vector<std::vector<Vec3>> pieces;  // extreme vertices of the largest connected pieces
  };

 private:
  const Scene& scene_;
  std::vector<MeshShape> shapes_;  // per mesh
};

}  // namespace standin
