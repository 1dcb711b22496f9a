// What is bound on the device during one frame: forwards real changes only, and counts them.
#pragma once

#include <array>
#include <cstdint>

#include "render/device/gl_functions.h"
#include "render/device/mesh_buffers.h"
#include "render/device/programs.h"
#include "render/device/renderer.h"

namespace standin {

/// Which faces are dropped; a mirroring transform turns back faces into front faces.
enum class Culling : std::uint8_t { kNone, kBack, kFront };

class BoundState {
 public:
  /// Sets all fixed state that a frame needs, whatever another renderer of the same context left behind.
  BoundState(const Gl& gl, const Programs& programs);

  void use(Program program);
  void use(Culling culling);
  void use_texture(GLuint texture);
  /// Uniforms of `material` in the program in use; `id` tells materials apart.
  void use_material(std::uint32_t id, const Material& material);
  void draw(const MeshRange& range, const Mat4& clip_from_mesh);

  FrameCounts counts;

 private:
  static constexpr std::int64_t kNothing = -1;
  const Gl& gl_;
  const Programs& programs_;
  std::int64_t program_ = kNothing;
  std::int64_t texture_ = kNothing;
  std::int64_t vertex_array_ = kNothing;
  Culling culling_ = Culling::kNone;
  std::array<std::int64_t, kProgramCount> material_of_program_;  // uniforms belong to the program
};

}  // namespace standin
