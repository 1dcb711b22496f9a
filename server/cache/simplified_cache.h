// Simplified meshes (render/scene/simplify_mesh.h) that outlive the job, one entry for the simpler forms of each mesh.
//
// They depend on the mesh's vertices and triangles, on whether a texture is worn, whether open borders stay, and on the accuracy asked for:
// whatever is edited elsewhere, and whatever the budget, they stay. A form is written as the mesh's vertices that it uses.
#pragma once

#include <vector>

#include "render/scene/simplify_mesh.h"
#include "server/cache/stage_cache.h"

namespace standin {

inline constexpr CacheStage kSimplified{"simplified"};

/// As simplified(), but for what `cache` remembers; simplified() itself where there is no cache, which must outlive it.
[[nodiscard]] Simplify simplified_through(StageCache* cache);

/// What the simpler forms of a mesh depend on.
[[nodiscard]] Fingerprint simplified_inputs(const Mesh& mesh, const SimplifyOptions& options);

}  // namespace standin
