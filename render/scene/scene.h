// The scene: what is drawn, as structs of arrays.
//
// An Object is a draw unit: one world transform and a range of Parts, each part one draw call (a mesh with a material). Objects that show
// the same meshes share them (instances). Positions are float relative to the mesh, transforms are double, so that a scene far from its
// origin keeps its precision. Everything is y up and in metres here, whatever the file was in (see Placing in load.h).
//
// Layout example, two objects of two and one parts:   objects: {first_part 0, part_count 2}, {2, 1};  parts: [p0 p1 p2]
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "render/base/geometry.h"

namespace standin {

/// RGBA8, rows from the top, straight alpha, colour values as stored in the file (sRGB encoded).
struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // width * height * 4
};

enum class AlphaMode { kOpaque, kMask };

struct Material {
  std::string name;
  glm::vec4 base_colour{1.0F};
  std::int32_t texture = -1;  // index into Scene::textures, -1: none
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = true;
  bool unlit = false;
};

/// Triangles; `normals` and `uvs` are as long as `positions`, or `uvs` is empty. Every index is in range and every value finite.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;          // v down, texture origin upper left (glTF)
  std::vector<std::uint32_t> indices;  // 3 per triangle
  Box bounds;                          // of positions, in mesh space
  double area_m2 = 0.0;                // sum of the triangles' areas, in mesh space
  std::int32_t simplified_from = -1;   // the mesh of the scene that this one stands in for (object_levels.h), -1: none
  bool is_piece = false;               // of an object that was split: not all triangles of the file's primitive
  std::vector<std::uint32_t>
      source;  // per vertex: its number in what the mesh was made from: that mesh, else the file's primitive; empty: the same
  [[nodiscard]] std::size_t triangle_count() const { return indices.size() / 3; }
};

struct Part {
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  std::int32_t gltf_mesh = -1;  // of the file, and its primitive: what a viewer of the file draws it as; -1: the file is no glTF
  std::uint32_t gltf_primitive = 0;
};

/// A simpler form of an object: parts drawn in place of its own where no eye is nearer to the object's bounds than `least_distance_m`.
struct ObjectLevel {
  std::uint32_t first_part = 0;
  std::uint32_t part_count = 0;
  std::uint64_t triangle_count = 0;
  double error_m = -1.0;          // world: how far its surface may lie from the object's own; negative: the scene's author vouches for it
  double screen_coverage = -1.0;  // at which the author switches to it; negative: not said
  double least_distance_m = std::numeric_limits<double>::infinity();  // for one camera (object_levels.h); before: never
};

struct Object {
  std::string name;
  std::string gltf_node;  // name of the node in the file it came from; "" where there is none
  Mat4 world_from_object{1.0};
  std::uint32_t first_part = 0;
  std::uint32_t part_count = 0;
  Box bounds;  // world
  std::uint64_t triangle_count = 0;
  double area_m2 = 0.0;             // world
  std::vector<ObjectLevel> levels;  // fewer and fewer triangles, from farther and farther; of a loaded scene: those of the file
};

/// What loading did to the file, for `standin info` (each entry: what, how many, why).
struct LoadNote {
  enum class Kind { kRepaired, kDropped, kChosen, kWarning } kind = Kind::kWarning;
  std::string what;
  std::uint64_t count = 0;
  std::string why;
};

struct Scene {
  std::string name;    // file name without folders
  std::string sha256;  // of the main file's bytes, hex
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Part> parts;
  std::vector<Object> objects;
  Box bounds;
  Mat4 world_from_file{1.0};  // the up and unit conversion that loading applied
  std::vector<LoadNote> notes;

  [[nodiscard]] std::uint64_t triangle_count() const {
    std::uint64_t sum = 0;
    for (const auto& object : objects) sum += object.triangle_count;
    return sum;
  }
};

/// Whether people look at the scene from outside, as at an exhibit: a single object, or extents within a factor of 3 of each other. They
/// walk about in others.
[[nodiscard]] bool is_exhibit(const Scene& scene);

/// Recomputes a mesh's bounds and area.
void update_derived(Mesh& mesh);
/// Recomputes meshes' bounds and areas and objects' bounds, triangle counts and areas, and the scene's bounds.
void update_derived(Scene& scene);

}  // namespace standin
