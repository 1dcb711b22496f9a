// One impostor of the GLB as a stack of parallel planes, for rays: which opaque texel does a ray meet first?
//
// All quads of a layer lie in one plane across `forward`. Seen from the reference viewpoint a point of a plane is a slope (right and up per
// unit of depth); per plane a grid over slopes tells which triangles may hold a point.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/verify/glb_quads.h"

namespace standin {

/// Orthonormal axes at the reference viewpoint; which way is up does not matter here.
struct StackFrame {
  Vec3 origin{0.0};
  Vec3 forward{0.0, 0.0, -1.0};
  Vec3 right{1.0, 0.0, 0.0};
  Vec3 up{0.0, 1.0, 0.0};
};
[[nodiscard]] StackFrame stack_frame(const Vec3& reference_viewpoint, const Vec3& forward);

class QuadStack {
 public:
  /// `quads` must outlive the stack. Throws Failure(kFileBroken) where a triangle is not parallel to its layer or lies behind the
  /// viewpoint.
  QuadStack(const GlbQuads& quads, const GlbImpostor& impostor, const StackFrame& frame);

  struct Texel {
    double depth_m = 0.0;     // of the plane, along forward from the reference viewpoint
    double distance_m = 0.0;  // along the ray
    Vec2 slope{0.0};          // where the ray meets the plane
    Vec2 slope_step{0.0};     // size of a texel there, along right and up
  };
  /// The first opaque texel along the ray (unit direction, leading towards `forward`, from before the stack's planes).
  [[nodiscard]] std::optional<Texel> first_opaque(const Vec3& origin, const Vec3& direction) const;
  [[nodiscard]] const StackFrame& frame() const { return frame_; }

 private:
  struct Triangle {
    Vec2 corner{0.0};        // slope of vertex 0
    Vec2 to_first{0.0};      // barycentric coordinate of vertex 1 = dot(to_first, slope - corner)
    Vec2 to_second{0.0};     // and of vertex 2
    Vec2 texel{0.0};         // texel coordinates of vertex 0
    Vec2 texel_first{0.0};   // their change towards vertex 1
    Vec2 texel_second{0.0};  // and 2
    Vec2 texel_min{0.0};     // the triangle's texels: a point on its border belongs to none beyond
    Vec2 texel_max{0.0};
    Vec2 slope_step{0.0};
    Vec2 slope_min{0.0};
    Vec2 slope_max{0.0};
    std::uint32_t page = 0;
  };
  struct Plane {
    double depth_m = 0.0;
    std::vector<Triangle> triangles;
    Vec2 low{0.0};  // slopes covered by the grid
    Vec2 bins_per_slope{0.0};
    std::vector<std::uint32_t> bin_first;  // kBins * kBins + 1 offsets into bin_items
    std::vector<std::uint32_t> bin_items;
  };

  [[nodiscard]] static Triangle make_triangle(const GlbTriangle& source, const std::array<Vec2, 3>& slopes);
  static void build_grid(Plane& plane);
  [[nodiscard]] const Triangle* opaque_at(const Plane& plane, const Vec2& slope) const;
  [[nodiscard]] bool is_opaque(const Triangle& triangle, double first, double second) const;

  const std::vector<GlbPage>& pages_;
  StackFrame frame_;
  std::vector<Plane> planes_;  // ascending depth
};

}  // namespace standin
