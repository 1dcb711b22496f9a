// Rays through the pixel centres of a view, and through those of the neighbouring pixels, whose difference is a pixel's footprint.
#pragma once

#include "render/view/camera.h"

namespace standin {

/// Pixels [x0, x1) x [y0, y1), rows from the top.
struct PixelWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// All directions of unit length.
struct PixelRay {
  Vec3 origin{0.0};
  Vec3 direction{0.0, 0.0, -1.0};
  Vec3 direction_right{0.0};  // through the centre of the pixel to the right
  Vec3 direction_down{0.0};   // and of the one below
};

/// How far the discs of gap pixels reach (impostor_rays.h), in pixels.
inline constexpr int kDiscRadius_px = 2;

class PixelRays {
 public:
  /// Both must outlive the rays.
  PixelRays(const View& view, const Camera& camera);

  [[nodiscard]] Vec3 direction(int x, int y) const;
  [[nodiscard]] PixelRay ray(int x, int y) const;
  /// Pixels of the image that may show the box, and those within a disc's radius.
  [[nodiscard]] PixelWindow window_of(const Box& box) const;

 private:
  const View& view_;
  const Camera& camera_;
  Vec2 tan_half_;
  Mat3 world_from_eye_;
};

}  // namespace standin
