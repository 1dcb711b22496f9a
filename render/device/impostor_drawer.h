// Draws baked impostors: textured triangles with vertices relative to their reference viewpoint, one draw for each atlas page an impostor
// uses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/device/bound_state.h"
#include "render/device/mesh_buffers.h"
#include "render/device/textures.h"
#include "render/impostor/impostor.h"
#include "render/view/camera.h"

namespace standin {

class ImpostorDrawer {
 public:
  ImpostorDrawer(const Gl& gl, const ImpostorSet& set);

  /// Sorted by page. Ids must be in range.
  void draw(BoundState& state, const Mat4& clip_from_world, std::span<const std::uint32_t> impostors) const;
  /// World bounds of what it shows; empty where that is nothing.
  [[nodiscard]] const Box& bounds(std::uint32_t impostor) const { return bounds_[impostor]; }
  [[nodiscard]] std::size_t count() const { return bounds_.size(); }

 private:
  /// An impostor's triangles on one page.
  struct Piece {
    std::uint32_t page = 0;
    std::uint32_t impostor = 0;
    MeshRange range;
  };
  using Vertices = std::vector<DeviceVertex>;
  using Indices = std::vector<std::uint32_t>;
  void add_impostor(const ImpostorSet& set, std::uint32_t id, Vertices& vertices, Indices& indices);

  Textures pages_;
  std::vector<VertexArray> array_;  // one; none for an empty set
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> first_piece_;  // of each impostor, and the end
  std::vector<Vec3> reference_viewpoints_;
  std::vector<Box> bounds_;
};

}  // namespace standin
