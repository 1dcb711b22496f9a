// All techniques behind one call: what placement and the command line need of an impostor is that it can be baked and what it promises.
//
// Layered impostors and depth meshes draw the same layers of texels (thesis 3.3), as quads or as a mesh that connects them (thesis 4); a
// planar impostor is a single such layer, a LOD-sprite one image on a coarse mesh of the objects. A further one is a further row here; who
// draws, packs, writes or judges impostors sees textured triangles alone (impostor.h).
#pragma once

#include "render/impostor/bake.h"

namespace standin {

/// As bake_layered. May return an empty impostor (nothing visible).
[[nodiscard]] Impostor bake_impostor(const Scene& scene, const TexturePyramids& textures, Technique technique, const BakeRequest& request,
                                     const Camera& camera, const BakeQuality& quality, const WorkBudget& budget = {});

}  // namespace standin
