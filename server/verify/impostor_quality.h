// How good one impostor is, as it ships: everything that can be measured of it without a placement.
//
// Rays judge views all over its view cell (impostor_rays.h): gap pixels, parallax ratio and bloat at nearest-texel sampling, which the
// promise is about, and at filtered sampling, which viewers do all the same. The device draws the originals and the impostor from the
// same views and from the reference viewpoint; the pictures are compared (image_error.h). Both look at the bytes of the written GLB.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "render/device/context.h"
#include "server/verify/impostor_rays.h"

namespace standin {

/// Means over the pixels that the original or the impostor covers: the empty rest of a picture is no success. 0..1.
struct CoveredError {
  double mean_error = 0.0;  // absolute difference of colour
  double mean_flip = 0.0;
};

struct ImpostorQuality {
  std::array<ImpostorJudgement, kAlphaSamplings.size()> by_sampling;  // nearest first
  std::optional<CoveredError> at_reference;                           // none where the picture there shows nothing
  std::optional<CoveredError> over_views;                             // mean of the views' means
};

struct QualityOptions {
  std::uint32_t views = 50;
  std::uint64_t seed = 1;
  int threads = 1;
  DeviceKind device = DeviceKind::kOsMesa;
};

/// `glb`: the bytes of a file whose only impostor is `baked`, of which nothing but its description is taken (objects, view cell, frame,
/// layers). Throws Failure(kFileBroken) where the file does not fit it.
[[nodiscard]] ImpostorQuality judge_quality(const Scene& scene, const Impostor& baked, const std::string& glb, const Camera& camera,
                                            double alpha_rad, const QualityOptions& options, const WorkBudget& budget);

/// "image" of a bake's metrics.json; the keys that verify has too mean the same, but image errors are over covered pixels.
[[nodiscard]] nlohmann::json quality_json(const ImpostorQuality& quality);

}  // namespace standin
