#include "render/device/mesh_buffers.h"

#include <cstddef>
#include <utility>

namespace standin {
namespace {

// Vertices after which the next mesh starts a new buffer: 32 MB, which bounds the copy held while uploading.
constexpr std::size_t kVerticesPerBuffer = std::size_t{1} << 20;

void append(const Mesh& mesh, std::vector<DeviceVertex>& vertices, std::vector<std::uint32_t>& indices) {
  const Vec3 origin = MeshBuffers::origin(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    vertices.push_back({.position = glm::vec3(Vec3(mesh.positions[i]) - origin),
                        .normal = mesh.normals[i],
                        .uv = mesh.uvs.empty() ? glm::vec2(0.0F) : mesh.uvs[i]});
  }
  indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
}

void describe_attribute(const Gl& gl, GLuint vertex_array, GLuint location, int components, std::size_t offset) {
  gl.EnableVertexArrayAttrib(vertex_array, location);
  gl.VertexArrayAttribFormat(vertex_array, location, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
  gl.VertexArrayAttribBinding(vertex_array, location, 0);
}

}  // namespace

VertexArray::VertexArray(const Gl& gl, std::span<const DeviceVertex> vertices, std::span<const std::uint32_t> indices) : gl_(&gl) {
  gl.CreateBuffers(2, buffers_);
  gl.NamedBufferStorage(buffers_[0], static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(), 0);
  gl.NamedBufferStorage(buffers_[1], static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(), 0);
  gl.CreateVertexArrays(1, &vertex_array_);
  gl.VertexArrayVertexBuffer(vertex_array_, 0, buffers_[0], 0, sizeof(DeviceVertex));
  gl.VertexArrayElementBuffer(vertex_array_, buffers_[1]);
  describe_attribute(gl, vertex_array_, 0, 3, offsetof(DeviceVertex, position));
  describe_attribute(gl, vertex_array_, 1, 3, offsetof(DeviceVertex, normal));
  describe_attribute(gl, vertex_array_, 2, 2, offsetof(DeviceVertex, uv));
}

VertexArray::VertexArray(VertexArray&& other) noexcept
    : gl_(other.gl_),
      buffers_{std::exchange(other.buffers_[0], 0), std::exchange(other.buffers_[1], 0)},
      vertex_array_(std::exchange(other.vertex_array_, 0)) {}

VertexArray::~VertexArray() {
  gl_->DeleteVertexArrays(1, &vertex_array_);
  gl_->DeleteBuffers(2, buffers_);
}

MeshBuffers::MeshBuffers(const Gl& gl, std::span<const Mesh> meshes) {
  std::vector<DeviceVertex> vertices;
  std::vector<std::uint32_t> indices;
  std::size_t first_unplaced = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    ranges_.push_back({.vertex_array = 0,
                       .base_vertex = static_cast<std::int32_t>(vertices.size()),
                       .first_index = indices.size(),
                       .index_count = static_cast<std::int32_t>(meshes[i].indices.size())});
    append(meshes[i], vertices, indices);
    if (vertices.size() < kVerticesPerBuffer && i + 1 < meshes.size()) continue;
    arrays_.emplace_back(gl, vertices, indices);
    for (; first_unplaced <= i; ++first_unplaced) ranges_[first_unplaced].vertex_array = arrays_.back().name();
    vertices.clear();
    indices.clear();
  }
}

}  // namespace standin
