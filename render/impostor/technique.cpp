#include "render/impostor/technique.h"

#include "render/impostor/bake_depth_mesh.h"

namespace standin {

Impostor bake_impostor(const Scene& scene, const TexturePyramids& textures, Technique technique, const BakeRequest& request,
                       const Camera& camera, const BakeQuality& quality, const WorkBudget& budget) {
  if (technique == Technique::kDepthMesh) return bake_depth_mesh(scene, textures, request, camera, quality, {}, budget);
  return bake_layered(scene, textures, request, camera, quality, budget);
}

}  // namespace standin
