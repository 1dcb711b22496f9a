// Simplified meshes (render/scene/simplify_mesh.h) that outlive the job, an entry for all simpler forms of a mesh by one set of options.
//
// They depend on the mesh's vertices and triangles, on whether a texture is worn, whether open borders stay, and on the accuracy asked for.
// Edits elsewhere matter only where they change whether another mesh meets those borders; the budget never does. A form is written as the
// mesh's vertices that it uses. Meshes too small to have any form are no entries.
#pragma once

#include <vector>

#include "render/scene/simplify_mesh.h"
#include "server/cache/stage_cache.h"

namespace standin {

inline constexpr CacheStage kSimplifiedMeshes{"simplified_meshes"};

/// As simplified(), but for what `cache` remembers, which must outlive it; simplified() itself where there is none.
[[nodiscard]] Simplify simplified_through(StageCache* cache);

/// What the simpler forms of a mesh depend on.
[[nodiscard]] Fingerprint simplified_inputs(const Mesh& mesh, const SimplifyOptions& options);

}  // namespace standin
