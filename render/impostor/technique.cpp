#include "render/impostor/technique.h"

#include "render/impostor/bake_depth_mesh.h"
#include "render/impostor/bake_lod_sprite.h"
#include "render/impostor/bake_planar.h"

namespace standin {

Impostor bake_impostor(const Scene& scene, const TexturePyramids& textures, Technique technique, const BakeRequest& request,
                       const Camera& camera, const BakeQuality& quality, const WorkBudget& budget) {
  switch (technique) {
    case Technique::kDepthMesh:
      return bake_depth_mesh(scene, textures, request, camera, quality, {}, budget);
    case Technique::kPlanar:
      return bake_planar(scene, textures, request, camera, quality, budget);
    case Technique::kLodSprite:
      return bake_lod_sprite(scene, textures, request, camera, quality, budget);
    case Technique::kLayered:
      break;
  }
  return bake_layered(scene, textures, request, camera, quality, budget);
}

}  // namespace standin
