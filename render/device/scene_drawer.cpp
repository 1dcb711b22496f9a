#include "render/device/scene_drawer.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace standin {
namespace {

// Normals go with the inverse transpose. Its multiple by the determinant, the cofactors, needs no division and exists for flattened
// objects too; the shader normalises and takes |n.l|, so scale and sign do not matter. Scaled to unit size against float underflow.
glm::mat3 cofactors(const Mat4& world_from_object) {
  const Mat3 m(world_from_object);
  const Mat3 result(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  double largest = 0.0;
  for (int i = 0; i < 9; ++i) largest = std::max(largest, std::abs(glm::value_ptr(result)[i]));
  return glm::mat3(largest > 0.0 ? result / largest : result);
}

Program program_of(const Material& material, const Mesh& mesh) {
  if (material.texture < 0 || mesh.uvs.empty()) return Program::kPlain;
  return material.alpha_mode == AlphaMode::kMask ? Program::kMasked : Program::kTextured;
}

// A mask without a texture passes everywhere or nowhere.
bool masked_away(const Material& material, Program program) {
  return program == Program::kPlain && material.alpha_mode == AlphaMode::kMask && material.base_colour.a < material.alpha_cutoff;
}

Culling culling_of(const Material& material, const Mat4& world_from_object) {
  if (material.double_sided) return Culling::kNone;
  return glm::determinant(Mat3(world_from_object)) < 0.0 ? Culling::kFront : Culling::kBack;
}

}  // namespace

SceneDrawer::SceneDrawer(const Gl& gl, const Scene& scene)
    : gl_(gl), scene_(scene), meshes_(gl, scene.meshes), textures_(gl, scene.textures, Filtering::kTrilinearRepeat) {
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id) add_object(scene, id);
  first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
}

void SceneDrawer::add_object(const Scene& scene, std::uint32_t id) {
  const Object& object = scene.objects[id];
  first_level_.push_back(static_cast<std::uint32_t>(first_piece_.size()));
  world_from_normal_.push_back(cofactors(object.world_from_object));
  for (std::uint32_t level = 0; level <= object.levels.size(); ++level) {
    first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
    add_parts(scene, id, parts_of(object, level));
  }
}

void SceneDrawer::add_parts(const Scene& scene, std::uint32_t id, const LevelParts& parts) {
  for (std::uint32_t i = 0; i < parts.part_count; ++i) {
    const Part& part = scene.parts[parts.first_part + i];
    const Material& material = scene.materials[part.material];
    const Program program = program_of(material, scene.meshes[part.mesh]);
    if (scene.meshes[part.mesh].indices.empty() || masked_away(material, program)) continue;
    pieces_.push_back({.object = id,
                       .mesh = part.mesh,
                       .material = part.material,
                       .program = program,
                       .culling = culling_of(material, scene.objects[id].world_from_object)});
  }
}

std::uint32_t SceneDrawer::Piece::state_rank(std::int32_t texture) const {
  const auto used_texture = program == Program::kPlain ? 0U : static_cast<std::uint32_t>(texture) + 1U;
  return static_cast<std::uint32_t>(program) << 30 | used_texture << 2 | static_cast<std::uint32_t>(culling);
}

void SceneDrawer::order(const Vec3& eye, std::span<const std::uint32_t> objects, std::span<const std::uint8_t> levels) {
  ordered_.clear();
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const double distance_m = glm::distance(eye, scene_.objects[objects[k]].bounds.centre());
    const std::uint32_t drawn = first_level_[objects[k]] + (levels.empty() ? 0U : levels[k]);
    for (std::uint32_t i = first_piece_[drawn]; i < first_piece_[drawn + 1]; ++i) {
      const std::uint32_t rank = pieces_[i].state_rank(scene_.materials[pieces_[i].material].texture);
      ordered_.push_back({.key = draw_key(pieces_[i].program == Program::kMasked, distance_m, rank), .distance_m = distance_m, .piece = i});
    }
  }
  std::sort(ordered_.begin(), ordered_.end());
}

void SceneDrawer::draw_piece(BoundState& state, const Mat4& clip_from_world, const Piece& piece) const {
  const Material& material = scene_.materials[piece.material];
  state.use(piece.program);
  state.use(piece.culling);
  if (piece.program != Program::kPlain) state.use_texture(textures_.name(static_cast<std::size_t>(material.texture)));
  state.use_material(piece.material, material);
  gl_.UniformMatrix3fv(kWorldFromNormal, 1, GL_FALSE, glm::value_ptr(world_from_normal_[piece.object]));
  const Mat4 clip_from_object = clip_from_world * scene_.objects[piece.object].world_from_object;
  state.draw(meshes_.range(piece.mesh), glm::translate(clip_from_object, MeshBuffers::origin(scene_.meshes[piece.mesh])));
}

void SceneDrawer::draw(BoundState& state, const Mat4& clip_from_world, const Vec3& eye, std::span<const std::uint32_t> objects,
                       std::span<const std::uint8_t> levels) {
  order(eye, objects, levels);
  for (const OrderedDraw& draw : ordered_) draw_piece(state, clip_from_world, pieces_[draw.piece]);
}

}  // namespace standin
