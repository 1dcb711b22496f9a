// What the readers of different formats share: the working state of one load, and the repair of what they read.
//
// A reader fills `scene` with meshes (cleaned), materials, textures and objects in the file's own coordinates (world_from_object holds
// file_from_object). load.cpp then re-centres, places, splits and prunes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "render/scene/file_access.h"
#include "render/scene/load.h"
#include "render/scene/scene.h"

namespace standin {

/// Adds to the entry of the same kind, thing and reason, or appends one. A count of 0 is no news and is not noted.
void add_note(Scene& scene, LoadNote::Kind kind, const std::string& what, std::uint64_t count, const std::string& why);

/// What the file says about its own coordinates; 0 or kAuto where it says nothing.
struct FileStatement {
  UpAxis up = UpAxis::kAuto;
  double metres_per_unit = 0.0;
  std::string source;  // "glTF 2.0", "UnitScaleFactor of the file" ...
};

struct Import {
  Scene scene;
  SceneFolder folder;
  LoadOptions options;
  FileStatement statement;
  std::uint64_t texels = 0;  // of all textures
};

/// Makes `mesh` keep the promises of scene.h: drops triangles that are out of range, not finite or without area, then unused vertices;
/// repairs normals (flat ones where there are none) and texture coordinates. Everything is noted. False if nothing is left.
[[nodiscard]] bool clean(Mesh& mesh, Scene& scene);

/// Its index in Scene::textures. Throws Failure(kTooLarge) where LoadOptions allow no further one of that size.
std::int32_t add_texture(Import& import, Texture texture);

void read_gltf(Import& import, std::span<const std::uint8_t> bytes);
void read_by_assimp(Import& import, const std::filesystem::path& file);

/// Moves meshes that lie far from their own origin there, and their objects the other way: float keeps its precision near zero.
void recentre(Scene& scene);
/// Splits what LoadOptions calls too heavy or too long (thesis 1.6); true if anything was. Leaves derived values to be updated.
bool split_objects(Scene& scene, const LoadOptions& options);
/// Removes meshes, materials and textures that no object shows.
void prune(Scene& scene);

/// True if some texel is less than half opaque.
[[nodiscard]] bool has_holes(const Texture& texture);

}  // namespace standin
