// The bake, step by step (thesis 3.2): plan and record, cull, cut into quads. One thread; many bakes run side by side.
#include "render/impostor/bake.h"

#include "render/impostor/atlas.h"
#include "render/impostor/culling.h"
#include "render/impostor/quads.h"
#include "render/impostor/recording.h"
#include "render/impostor/texture_pyramid.h"

namespace standin {
namespace {

/// Appends the quad's block of texels; each texel goes to the first quad that holds it.
void append_block(const LayerImage& image, const Quad& quad, BitImage& left, std::vector<std::uint8_t>& texels) {
  for (std::uint32_t y = quad.y; y < quad.y + quad.height; ++y)
    for (std::uint32_t x = quad.x; x < quad.x + quad.width; ++x) {
      const auto rgba = left.test(x, y) ? image.get(x, y).rgba : std::array<std::uint8_t, 4>{0, 0, 0, 0};
      texels.insert(texels.end(), rgba.begin(), rgba.end());
      left.clear(x, y);
    }
}

void cut_into_quads(const std::vector<LayerImage>& images, const BakeQuality& quality, const WorkBudget& budget, Impostor& impostor) {
  OcclusionCulling culling(impostor.frame.width, impostor.frame.height, CullRule::kCorner);
  const BoxGrowing settings{.grid_texels = quality.grid_texels, .fill_ratio = quality.fill_ratio, .gutter = AtlasOptions{}.gutter};
  for (std::uint32_t layer = 0; layer < images.size(); ++layer) {
    budget.check();
    BitImage opaque = opaque_texels(images[layer]);
    if (images.size() > 1 || !quality.leave_out) opaque -= culling.hidden_in_next(opaque);
    if (images[layer].empty()) continue;
    const std::vector<Quad> quads = grow_quads(opaque, layer, settings);
    for (const Quad& quad : quads) append_block(images[layer], quad, opaque, impostor.texels);
    impostor.quads.insert(impostor.quads.end(), quads.begin(), quads.end());
  }
}

}  // namespace

Impostor bake_layered(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                      const BakeQuality& quality, const WorkBudget& budget) {
  const Recording recording = record_request(scene, textures, request, camera, quality, budget);
  Impostor impostor{request.objects, request.view_cell, recording.frame, recording.layers, {}, {}, {}, Technique::kLayered};
  impostor.fuzzy = recording.fuzzy;
  cut_into_quads(recording.images, quality, budget, impostor);
  return impostor;
}

Impostor bake_layered(const Scene& scene, const BakeRequest& request, const Camera& camera, const BakeQuality& quality,
                      const WorkBudget& budget) {
  return bake_layered(scene, TexturePyramids(scene), request, camera, quality, budget);
}

}  // namespace standin
