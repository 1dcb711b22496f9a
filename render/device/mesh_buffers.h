// Meshes on the device: interleaved vertices in a few large buffers, drawn with a base vertex.
//
// Positions are stored relative to their mesh's centre, so that a model whose file holds large coordinates loses nothing more to float:
// clip_from_mesh, made in double, holds the large part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/device/gl_functions.h"
#include "render/scene/scene.h"

namespace standin {

struct DeviceVertex {
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec2 uv;
};

/// Indices [first_index, first_index + index_count) of a vertex array.
struct MeshRange {
  GLuint vertex_array = 0;
  std::int32_t base_vertex = 0;
  std::size_t first_index = 0;
  std::int32_t index_count = 0;
};

/// One vertex buffer and one index buffer, filled once.
class VertexArray {
 public:
  VertexArray(const Gl& gl, std::span<const DeviceVertex> vertices, std::span<const std::uint32_t> indices);
  ~VertexArray();
  VertexArray(VertexArray&& other) noexcept;
  VertexArray(const VertexArray&) = delete;
  VertexArray& operator=(const VertexArray&) = delete;

  [[nodiscard]] GLuint name() const { return vertex_array_; }

 private:
  const Gl* gl_;
  GLuint buffers_[2] = {0, 0};  // vertices, indices
  GLuint vertex_array_ = 0;
};

class MeshBuffers {
 public:
  MeshBuffers(const Gl& gl, std::span<const Mesh> meshes);

  [[nodiscard]] const MeshRange& range(std::uint32_t mesh) const { return ranges_[mesh]; }
  /// Mesh-space point that the stored positions are relative to.
  [[nodiscard]] static Vec3 origin(const Mesh& mesh) { return mesh.bounds.empty() ? Vec3(0.0) : mesh.bounds.centre(); }

 private:
  std::vector<VertexArray> arrays_;
  std::vector<MeshRange> ranges_;
};

}  // namespace standin
