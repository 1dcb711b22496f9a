// lods.glb: levels of detail as what they add to a scene that is there already (not in the paper, which takes levels as given).
//
// A simplified mesh uses vertices of the original alone, so of a glTF scene the file holds lists of corners and nothing else: vertices,
// textures and materials are those of the scene's own primitive, which `extras` of each primitive names (scene_mesh, scene_primitive).
// POSITION is an accessor without data, zeros by the standard: it makes the file a valid glTF, but nothing to look at. A primitive without
// indices stands for the scene's as it is; of a piece of a split object there always are some. What is not glTF has no vertices to refer
// to: of such a scene levels hold vertices of their own, in the space of their object (lods.objects[].world_from_object of placement.json),
// and materials their names and that of their texture (`extras`, scene_texture), without the texture.
//
// Node lod_K is level K; its primitives follow the order of the object's parts, whose materials they wear.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// Numbers of all levels, as their (first part, number of parts): instances share them.
using LevelNumbers = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;
[[nodiscard]] LevelNumbers number_levels(const Scene& scene);

struct LevelFile {
  std::string glb;
  std::uint64_t buffer_bytes = 0;  // of it: what is to be kept beside the scene
};

/// Of all levels of a scene.
[[nodiscard]] LevelFile write_levels(const Scene& scene);

/// What a part of a level adds to the file's buffers.
[[nodiscard]] double level_bytes(const Scene& scene, const Part& part);

/// What placement.json says about a level.
struct StatedLevel {
  std::uint32_t object = 0;
  std::string gltf_node;  // of lods.glb
  double least_distance_m = 0.0;
  double error_m = -1.0;  // negative: the scene's author vouches for it
  std::uint64_t triangle_count = 0;
};

/// Where the vertices of an object's levels belong; nothing where they are those of the scene file's own node, which says it. (Vertices of
/// the scene may lie elsewhere than the file's: meshes far from their origin are brought home.)
[[nodiscard]] std::optional<Mat4> level_transform(const Scene& scene, const Object& object);

/// By object, from fine to coarse.
[[nodiscard]] std::vector<StatedLevel> stated_levels(const Scene& scene);

/// Gives objects of a scene, as it was loaded, the stated levels from the bytes of their file, and takes all others away; returns how many
/// bytes of buffers the file holds. Throws Failure(kFileBroken) where it does not hold them.
std::uint64_t read_levels(std::span<const StatedLevel> stated, const std::string& glb, Scene& scene);

}  // namespace standin
