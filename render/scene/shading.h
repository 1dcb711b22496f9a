// The one shading rule, used by the device's shader and by the impostor recorder alike (a test holds them together).
//
//   colour = base_colour * texture * (unlit ? 1 : ambient + diffuse * |dot(n, light)|)
//
// on the encoded (sRGB) values, two-sided, with one light fixed in the world: what an impostor recorded from one viewpoint shows is right
// from every other. Alpha masks compare base_colour.a * texture.a with the cutoff.
#pragma once

#include "render/base/geometry.h"

namespace standin {

inline constexpr double kAmbient = 0.45;
inline constexpr double kDiffuse = 0.55;
/// Unit vector to the light, world space: normalise(0.4, 0.8, 0.45).
[[nodiscard]] inline Vec3 light_direction() {
  return glm::normalize(Vec3(0.4, 0.8, 0.45));
}

}  // namespace standin
