// Draws objects of an uploaded scene. A piece is one part of one object: one draw call with its state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/device/bound_state.h"
#include "render/device/draw_order.h"
#include "render/device/mesh_buffers.h"
#include "render/device/textures.h"
#include "render/scene/object_levels.h"
#include "render/scene/scene.h"

namespace standin {

class SceneDrawer {
 public:
  /// `scene` must outlive it.
  SceneDrawer(const Gl& gl, const Scene& scene);

  /// Opaque pieces front to back, then masked ones. Ids and levels must be in range; no levels: the objects' own parts.
  void draw(BoundState& state, const Mat4& clip_from_world, const Vec3& eye, std::span<const std::uint32_t> objects,
            std::span<const std::uint8_t> levels);

 private:
  struct Piece {
    std::uint32_t object = 0;
    std::uint32_t mesh = 0;
    std::uint32_t material = 0;
    Program program = Program::kPlain;
    Culling culling = Culling::kNone;
    [[nodiscard]] std::uint32_t state_rank(std::int32_t texture) const;
  };
  void add_object(const Scene& scene, std::uint32_t id);
  void add_parts(const Scene& scene, std::uint32_t id, const LevelParts& parts);
  void order(const Vec3& eye, std::span<const std::uint32_t> objects, std::span<const std::uint8_t> levels);
  void draw_piece(BoundState& state, const Mat4& clip_from_world, const Piece& piece) const;

  const Gl& gl_;
  const Scene& scene_;
  MeshBuffers meshes_;
  Textures textures_;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> first_level_;    // of each object, into first_piece_
  std::vector<std::uint32_t> first_piece_;    // of each object's levels in turn, and the end
  std::vector<glm::mat3> world_from_normal_;  // of each object
  std::vector<OrderedDraw> ordered_;          // of the last frame; kept for its capacity
};

}  // namespace standin
