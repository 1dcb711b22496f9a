// What every technique that bakes starts with: check the request, plan, record the layers.
#pragma once

#include <string>

#include "render/base/error.h"
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

/// Plans for a request's objects, fitted to their vertices, which are gathered once for many view cells.
class RequestPlanner {
 public:
  /// Throws Failure(kBadUsage) for a request that names no object or one that is not there.
  RequestPlanner(const Scene& scene, const BakeRequest& request);
  [[nodiscard]] ImpostorPlan plan(const ViewCell& cell, const Camera& camera, const BakeQuality& quality) const;

 private:
  Box bounds_;
  std::vector<Vec3> points_;
};

/// The plan for the request; throws Failure(kImpostorImpossible) as well where there is none.
[[nodiscard]] ImpostorPlan plan_request(const Scene& scene, const BakeRequest& request, const Camera& camera, const BakeQuality& quality);
/// Failure(kImpostorImpossible) with the reason, naming the request's objects.
[[nodiscard]] Failure impossible(const BakeRequest& request, const std::string& why);

/// Throws Failure(kBadUsage) for a request that names no object or one that is not there, Failure(kImpostorImpossible) where no plan is
/// possible.
[[nodiscard]] Recording record_request(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request,
                                       const Camera& camera, const BakeQuality& quality, const WorkBudget& budget);

[[nodiscard]] BitImage opaque_texels(const LayerImage& image);

}  // namespace standin
