// Two clean-ups of a whole scene: meshes far from their own origin come home, and what nobody shows goes.

#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <set>
#include <tuple>

#include "render/scene/import.h"

namespace standin {
namespace {

// A mesh farther from its origin than this many times its own size loses precision wherever floats are used.
constexpr double kFar = 8.0;

using Range = std::pair<std::uint32_t, std::uint32_t>;

Box bounds_of(const Scene& scene, const Range& range) {
  Box bounds;
  for (std::uint32_t p = 0; p < range.second; ++p) {
    for (const glm::vec3& position : scene.meshes[scene.parts[range.first + p].mesh].positions) bounds.extend(Vec3(position));
  }
  return bounds;
}

// Where to move the origin: a point that float represents, so that differences to it are exact or nearly so.
Vec3 new_origin(const Box& bounds) {
  const double farthest = glm::length(glm::max(glm::abs(bounds.min), glm::abs(bounds.max)));
  return farthest > kFar * bounds.diagonal() ? Vec3(glm::vec3(bounds.centre())) : Vec3(0.0);
}

Mesh moved(const Mesh& mesh, const Vec3& origin) {
  Mesh result = mesh;
  for (glm::vec3& position : result.positions) position = glm::vec3(Vec3(position) - origin);
  return result;
}

// Levels of an object share its transform, so it stays as it is.
std::set<Range> ranges_of_levels(const Scene& scene) {
  std::set<Range> ranges;
  for (const Object& object : scene.objects) {
    if (!object.levels.empty()) ranges.emplace(object.first_part, object.part_count);
    for (const ObjectLevel& level : object.levels) ranges.emplace(level.first_part, level.part_count);
  }
  return ranges;
}

// Marks which of `count` items are used and numbers those anew, in order.
class Renumbering {
 public:
  explicit Renumbering(std::size_t count) : place_(count, -1) {}
  void use(std::size_t i) { place_[i] = 0; }
  [[nodiscard]] std::uint32_t operator[](std::size_t i) const { return static_cast<std::uint32_t>(place_[i]); }

  template <typename T>
  void compact(std::vector<T>& items) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (place_[i] < 0) continue;
      place_[i] = static_cast<std::int64_t>(kept);
      if (kept != i) items[kept] = std::move(items[i]);
      ++kept;
    }
    items.resize(kept);
  }

 private:
  std::vector<std::int64_t> place_;
};

}  // namespace

void recentre(Scene& scene) {
  const std::set<Range> of_levels = ranges_of_levels(scene);
  std::map<Range, Vec3> origins;
  std::map<std::tuple<std::uint32_t, double, double, double>, std::uint32_t> moved_meshes;  // two ranges may share a mesh
  for (Object& object : scene.objects) {
    const Range range{object.first_part, object.part_count};
    const auto [known, fresh] = origins.try_emplace(range, Vec3(0.0));
    if (fresh && !of_levels.contains(range)) known->second = new_origin(bounds_of(scene, range));
    const Vec3 origin = known->second;
    if (origin == Vec3(0.0)) continue;
    object.world_from_object = glm::translate(object.world_from_object, origin);
    for (std::uint32_t p = 0; fresh && p < range.second; ++p) {
      std::uint32_t& mesh = scene.parts[range.first + p].mesh;
      const auto [place, is_new] = moved_meshes.try_emplace({mesh, origin.x, origin.y, origin.z}, 0);
      if (is_new) {
        place->second = static_cast<std::uint32_t>(scene.meshes.size());
        scene.meshes.push_back(moved(scene.meshes[mesh], origin));
      }
      mesh = place->second;
    }
  }
}

void prune(Scene& scene) {
  std::vector<Part> parts;
  std::map<Range, std::uint32_t> new_first;
  const auto keep = [&](std::uint32_t& first_part, std::uint32_t part_count) {
    const auto [place, fresh] = new_first.try_emplace({first_part, part_count}, static_cast<std::uint32_t>(parts.size()));
    const auto first = scene.parts.begin() + first_part;
    if (fresh) parts.insert(parts.end(), first, first + part_count);
    first_part = place->second;
  };
  for (Object& object : scene.objects) {
    keep(object.first_part, object.part_count);
    for (ObjectLevel& level : object.levels) keep(level.first_part, level.part_count);
  }
  scene.parts = std::move(parts);
  Renumbering meshes(scene.meshes.size());
  Renumbering materials(scene.materials.size());
  Renumbering textures(scene.textures.size());
  for (const Part& part : scene.parts) {
    meshes.use(part.mesh);
    materials.use(part.material);
    const std::int32_t texture = scene.materials[part.material].texture;
    if (texture >= 0) textures.use(static_cast<std::size_t>(texture));
  }
  meshes.compact(scene.meshes);
  materials.compact(scene.materials);
  textures.compact(scene.textures);
  for (Part& part : scene.parts) {
    part.mesh = meshes[part.mesh];
    part.material = materials[part.material];
  }
  for (Material& material : scene.materials) {
    if (material.texture >= 0) material.texture = static_cast<std::int32_t>(textures[static_cast<std::size_t>(material.texture)]);
  }
}

}  // namespace standin
