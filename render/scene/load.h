// From a scene file to a Scene.
//
// glTF/GLB is read through tinygltf with our own bounds checks (fast: about a second for 10 M triangles), all else through Assimp.
// A URI inside a scene never leaves the scene's folder; required extensions that are not read are refused by name;
// NaN, Inf and out-of-range indices are dropped and counted in Scene::notes, or refused when nothing is left.
#pragma once

#include <filesystem>
#include <string>

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
};

/// Throws Failure (kFileMissing, kFileBroken, kUriForbidden, kExtensionUnknown, kSceneEmpty).
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

/// Writes `scene` as one GLB: instances stay instances, textures embedded as PNG. Whole or not at all.
void write_scene_glb(const Scene& scene, const std::filesystem::path& file);

}  // namespace standin
