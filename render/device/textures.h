// Textures on the device, as RGBA8 of encoded values (no sRGB decoding: render/scene/shading.h works on those).
#pragma once

#include <span>
#include <vector>

#include "render/device/gl_functions.h"
#include "render/scene/scene.h"

namespace standin {

enum class Filtering { kTrilinearRepeat, kNearestClamp };

class Textures {
 public:
  /// Throws Failure(kDeviceUnavailable) naming a texture that is larger than the device allows.
  Textures(const Gl& gl, std::span<const Texture> textures, Filtering filtering);
  ~Textures();
  Textures(const Textures&) = delete;
  Textures& operator=(const Textures&) = delete;

  [[nodiscard]] GLuint name(std::size_t index) const { return names_[index]; }

 private:
  const Gl& gl_;
  std::vector<GLuint> names_;
};

}  // namespace standin
