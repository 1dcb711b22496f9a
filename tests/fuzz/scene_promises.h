// What scene.h promises of a scene that was loaded: everything behind the loader relies on it and looks no more.
#pragma once

#include <cmath>

#include "render/scene/scene.h"
#include "tests/fuzz/input_file.h"

namespace standin::fuzz {

template <class Vector>
bool finite(const Vector& vector) {
  for (int axis = 0; axis < Vector::length(); ++axis)
    if (!std::isfinite(vector[axis])) return false;
  return true;
}

template <class Vector>
bool all_finite(const std::vector<Vector>& vectors) {
  for (const Vector& vector : vectors)
    if (!finite(vector)) return false;
  return true;
}

inline void check_mesh(const Mesh& mesh) {
  require(!mesh.indices.empty() && mesh.indices.size() % 3 == 0, "a mesh has triangles");
  for (const std::uint32_t index : mesh.indices) require(index < mesh.positions.size(), "an index names a vertex");
  require(mesh.normals.size() == mesh.positions.size(), "each vertex has a normal");
  require(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size(), "each vertex has texture coordinates, or none has");
  require(mesh.source.empty() || mesh.source.size() == mesh.positions.size(), "each vertex has a source, or none has");
  require(all_finite(mesh.positions) && all_finite(mesh.normals) && all_finite(mesh.uvs), "vertices are finite");
  require(std::isfinite(mesh.area_m2) && finite(mesh.bounds.min) && finite(mesh.bounds.max), "a mesh has finite bounds and area");
}

inline void check_look(const Scene& scene) {
  for (const Material& material : scene.materials) {
    require(material.texture < static_cast<std::int32_t>(scene.textures.size()), "a material's texture is there");
    require(finite(material.base_colour) && std::isfinite(material.alpha_cutoff), "a material is finite");
  }
  for (const Texture& texture : scene.textures) {
    require(texture.width > 0 && texture.height > 0, "a texture has texels");
    require(texture.rgba.size() == std::size_t{4} * static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height),
            "a texture has all its texels");
  }
}

inline void check_parts(const Scene& scene, std::uint32_t first, std::uint32_t count) {
  require(count > 0 && first <= scene.parts.size() && count <= scene.parts.size() - first, "an object's parts are there");
}

inline void check_scene(const Scene& scene) {
  require(!scene.objects.empty() && scene.triangle_count() > 0, "something is drawn");
  for (const Mesh& mesh : scene.meshes) check_mesh(mesh);
  check_look(scene);
  for (const Part& part : scene.parts)
    require(part.mesh < scene.meshes.size() && part.material < scene.materials.size(), "a part's mesh and material are there");
  for (const Object& object : scene.objects) {
    check_parts(scene, object.first_part, object.part_count);
    for (const ObjectLevel& level : object.levels) check_parts(scene, level.first_part, level.part_count);
    require(finite(object.bounds.min) && finite(object.bounds.max) && !object.bounds.empty(), "an object has finite bounds");
    require(object.area_m2 > 0.0 && std::isfinite(object.area_m2), "an object has an area");
    for (int column = 0; column < 4; ++column) require(finite(object.world_from_object[column]), "an object's transform is finite");
  }
  require(finite(scene.bounds.min) && finite(scene.bounds.max), "a scene has finite bounds");
}

}  // namespace standin::fuzz
