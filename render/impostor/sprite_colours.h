// The colours of a LOD-sprite: the image of the reference viewpoint, projected onto the coarse mesh (VIS'99, section 3), and where that
// image does not show the mesh's point, the colour of the nearest original surface.
//
// The image's point on the ray through a point of the mesh and that point itself must be one to all viewers: within alpha from every corner
// of the view cell (sprite_error.h). So what is hidden from the reference viewpoint does not take the colour of what hides it. A triangle
// seen edge-on from there would be smeared over few texels of the image; it too takes its own surface's colour.
#pragma once

#include "render/impostor/cluster_surface.h"
#include "render/impostor/layer_image.h"
#include "render/impostor/sprite_error.h"

namespace standin {

class SpriteColours {
 public:
  /// `image` is one layer, recorded from the reference viewpoint. All arguments must outlive this.
  SpriteColours(const Scene& scene, const TexturePyramids& textures, const std::vector<SurfaceTriangle>& surface,
                const ImpostorFrame& frame, const LayerImage& image, const Layer& layer, std::span<const Vec3> viewpoints,
                double alpha_rad);

  /// Of a point of the mesh whose triangle has the unit normal `normal`.
  [[nodiscard]] std::array<std::uint8_t, 4> at(const Vec3& offset, const Vec3& normal) const;

 private:
  [[nodiscard]] std::optional<std::array<std::uint8_t, 4>> of_image(const Vec3& offset, const Vec3& normal) const;
  [[nodiscard]] std::array<std::uint8_t, 4> of_surface(const Vec3& offset, const Vec3& normal) const;

  const Scene& scene_;
  const TexturePyramids& textures_;
  const std::vector<SurfaceTriangle>& surface_;
  const ImpostorFrame& frame_;
  const LayerImage& image_;
  const Layer& layer_;
  std::span<const Vec3> viewpoints_;
  double alpha_rad_;
  TriangleTree tree_;
};

}  // namespace standin
