// What every technique that bakes starts with: check the request, plan, record the layers.
#pragma once

#include "render/impostor/bake.h"
#include "render/impostor/bit_image.h"
#include "render/impostor/layer_image.h"

namespace standin {

struct Recording {
  ImpostorFrame frame;
  std::vector<Layer> layers;
  std::vector<LayerImage> images;  // one a layer
  bool fuzzy = false;              // without the outlines of masked surfaces, of which there are some
};

/// Throws Failure(kBadUsage) for a request that names no object or one that is not there, Failure(kImpostorImpossible) where no plan is
/// possible.
[[nodiscard]] Recording record_request(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request,
                                       const Camera& camera, const BakeQuality& quality, const WorkBudget& budget);

[[nodiscard]] BitImage opaque_texels(const LayerImage& image);

}  // namespace standin
