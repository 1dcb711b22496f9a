// The four shader programs: the shading rule of render/scene/shading.h for plain, textured and textured alpha-masked surfaces, and unlit
// nearest-filtered texels for impostors. Few variants on purpose: a program switch costs llvmpipe about 30 us.
#pragma once

#include <array>
#include <cstdint>

#include "render/device/gl_functions.h"

namespace standin {

enum class Program : std::uint8_t { kPlain, kTextured, kMasked, kImpostor };
inline constexpr std::size_t kProgramCount = 4;

/// Uniform locations, the same in every program that has them.
enum Uniform : GLint {
  kClipFromMesh = 0,     // mat4
  kWorldFromNormal = 1,  // mat3: cofactors of world_from_object, not for impostors
  kBaseColour = 2,       // vec4
  kAmbientDiffuse = 3,   // vec2; (1, 0) is unlit
  kAlphaCutoff = 4,      // float, kMasked
  kLightDirection = 5,   // vec3, set once
};

class Programs {
 public:
  explicit Programs(const Gl& gl);
  ~Programs();
  Programs(const Programs&) = delete;
  Programs& operator=(const Programs&) = delete;

  [[nodiscard]] GLuint name(Program program) const { return names_[static_cast<std::size_t>(program)]; }

 private:
  const Gl& gl_;
  std::array<GLuint, kProgramCount> names_{};
};

}  // namespace standin
