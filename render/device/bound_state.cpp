#include "render/device/bound_state.h"

#include <glm/gtc/type_ptr.hpp>

#include "render/scene/shading.h"

namespace standin {

BoundState::BoundState(const Gl& gl, const Programs& programs) : gl_(gl), programs_(programs) {
  material_of_program_.fill(kNothing);
  gl_.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_GREATER);
  gl_.Disable(GL_DITHER);
  gl_.Disable(GL_CULL_FACE);
}

void BoundState::use(Program program) {
  if (program_ == static_cast<std::int64_t>(program)) return;
  program_ = static_cast<std::int64_t>(program);
  gl_.UseProgram(programs_.name(program));
  ++counts.program_switches;
}

void BoundState::use(Culling culling) {
  if (culling_ == culling) return;
  culling_ = culling;
  if (culling == Culling::kNone) return gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_CULL_FACE);
  gl_.CullFace(culling == Culling::kBack ? GL_BACK : GL_FRONT);
}

void BoundState::use_texture(GLuint texture) {
  if (texture_ == texture) return;
  texture_ = texture;
  gl_.BindTextureUnit(0, texture);
  ++counts.texture_switches;
}

void BoundState::use_material(std::uint32_t id, const Material& material) {
  auto& current = material_of_program_[static_cast<std::size_t>(program_)];
  if (current == id) return;
  current = id;
  gl_.Uniform4fv(kBaseColour, 1, glm::value_ptr(material.base_colour));
  gl_.Uniform2f(kAmbientDiffuse, material.unlit ? 1.0F : static_cast<float>(kAmbient),
                material.unlit ? 0.0F : static_cast<float>(kDiffuse));
  if (program_ == static_cast<std::int64_t>(Program::kMasked)) gl_.Uniform1f(kAlphaCutoff, material.alpha_cutoff);
}

void BoundState::draw(const MeshRange& range, const Mat4& clip_from_mesh) {
  if (vertex_array_ != range.vertex_array) {
    vertex_array_ = range.vertex_array;
    gl_.BindVertexArray(range.vertex_array);
  }
  const glm::mat4 matrix(clip_from_mesh);
  gl_.UniformMatrix4fv(kClipFromMesh, 1, GL_FALSE, glm::value_ptr(matrix));
  // OpenGL takes the offset into the bound index buffer as a pointer. NOLINTNEXTLINE(performance-no-int-to-ptr)
  const void* first = reinterpret_cast<const void*>(range.first_index * sizeof(std::uint32_t));
  gl_.DrawElementsBaseVertex(GL_TRIANGLES, range.index_count, GL_UNSIGNED_INT, first, range.base_vertex);
  ++counts.draws;
  counts.triangles += static_cast<std::uint64_t>(range.index_count) / 3;
}

}  // namespace standin
