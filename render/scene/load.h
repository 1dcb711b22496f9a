// From a scene file to a Scene.
//
// glTF/GLB has a reader of its own (3.4 s of processor time for 10.4 M triangles in 549 MB, under 1 s where they are instances): its JSON
// is parsed by nlohmann-json, and every byte range is checked before it is read. tinygltf would open any URI, copy the binary chunk and
// crash on some malformed files, so that nothing but a JSON parser would be left of it behind our own checks. All other formats go through
// Assimp.
//
// A URI inside a scene never leaves the scene's folder; required extensions that are not read are refused by name; NaN, Inf and
// out-of-range indices are dropped and counted in Scene::notes, or refused when nothing is left.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

enum class UpAxis { kAuto, kX, kY, kZ };

/// How file coordinates become world coordinates (y up, metres).
struct Placing {
  UpAxis up = UpAxis::kAuto;     // auto: y for glTF; for other formats the file's own statement, else y; noted
  double metres_per_unit = 0.0;  // 0: auto (glTF: 1; else the file's own statement, else 1; noted)
};

struct LoadOptions {
  Placing placing;
  std::uint64_t split_triangles = 100000;  // an object with more is split by a kd tree (thesis 1.6); 0: never
  double split_extent = 0.125;             // nor may one be longer than this share of the scene's diagonal; 0: any length
  std::uint64_t max_triangles = 200'000'000;
  std::uint64_t max_texels = 1'000'000'000;            // of all textures together
  std::vector<std::filesystem::path> texture_folders;  // where else textures may be found by their file name; not for glTF
};

/// Throws Failure (kFileMissing, kFileBroken, kUriForbidden, kExtensionUnknown, kSceneEmpty, kTooLarge).
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

/// `scene` as one GLB: instances stay instances, textures embedded as PNG; levels of detail are not part of it.
[[nodiscard]] std::string scene_glb(const Scene& scene);
/// Writes it, whole or not at all.
void write_scene_glb(const Scene& scene, const std::filesystem::path& file);

}  // namespace standin
