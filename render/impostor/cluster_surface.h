// The surfaces of a cluster as one list of triangles, for techniques that start from the objects' own geometry instead of recorded layers
// (LOD-sprite).
//
// Triangles that no viewer in the view cell can face are left out where their material is single-sided: a device culls them.
#pragma once

#include "render/impostor/bake.h"
#include "render/impostor/surface.h"

namespace standin {

struct SurfaceTriangle {
  std::array<Vec3, 3> corners{Vec3(0.0), Vec3(0.0), Vec3(0.0)};  // from the reference viewpoint, world axes
  TriangleAttributes attributes;
  std::uint32_t material = 0;
  bool textured = false;  // by its material's texture: the mesh has coordinates for it
};

/// Unit normal of the side from which the corners run counter-clockwise; 0 where there is no area.
[[nodiscard]] Vec3 unit_normal(const std::array<Vec3, 3>& corners);

/// Where viewers are: the corners of the view cell's near border (shaft) or all corners (box), from the reference viewpoint.
[[nodiscard]] std::vector<Vec3> corner_viewpoints(const ViewCell& cell, const Vec3& reference_viewpoint);

/// Every object's surface is opaque. Throws Failure(kImpostorImpossible) for a masked material: there the shape lies in the texture.
[[nodiscard]] std::vector<SurfaceTriangle> cluster_surface(const Scene& scene, const BakeRequest& request, const Vec3& reference_viewpoint);

}  // namespace standin
