#include "server/verify/impostor_quality.h"

#include <algorithm>
#include <cstdlib>
#include <span>

#include "render/device/renderer.h"
#include "render/image/image_error.h"
#include "render/scene/object_bounds.h"
#include "server/verify/frame_pictures.h"
#include "server/verify/shipped_impostors.h"

namespace standin {
namespace {

using nlohmann::json;

/// A placement of this one impostor, for whoever reads the file back.
Placement placement_of(const Impostor& baked) {
  PlacementImpostor placed;
  placed.technique = technique_name(baked.technique);
  placed.objects = baked.objects;
  placed.view_cell = baked.view_cell;
  placed.frame = baked.frame;
  placed.layers = baked.layers;
  placed.quads = static_cast<std::uint32_t>((textured_mesh(baked).triangle_count() + 1) / 2);
  Placement placement;
  placement.impostors.push_back(std::move(placed));
  return placement;
}

JudgedImpostor judged(const Impostor& baked, double alpha_rad) {
  return {"imp_0",         baked.objects, baked.layers,    baked.frame.reference_viewpoint, baked.frame.forward,
          baked.view_cell, alpha_rad,     baked.technique, baked.frame.slope_step};
}

std::optional<CoveredError> covered_error(const PicturePair& pictures) {
  const std::vector<float> flip = flip_map(pictures.original, pictures.with_impostors);
  CoveredError sum;
  std::uint64_t covered = 0;
  for (std::size_t pixel = 0; pixel < flip.size(); ++pixel) {
    const std::uint8_t* a = &pictures.original.rgba[4 * pixel];
    const std::uint8_t* b = &pictures.with_impostors.rgba[4 * pixel];
    if (a[3] == 0 && b[3] == 0) continue;
    ++covered;
    for (int c = 0; c < 3; ++c) sum.mean_error += std::abs(int{a[c]} - int{b[c]}) / (3.0 * 255.0);
    sum.mean_flip += double{flip[pixel]};
  }
  if (covered == 0) return std::nullopt;
  const auto count = static_cast<double>(covered);
  return CoveredError{sum.mean_error / count, sum.mean_flip / count};
}

/// One for each view, on a device of its own.
std::vector<std::optional<CoveredError>> covered_errors(const Scene& scene, const ImpostorSet& shipped, const Camera& camera,
                                                        const std::vector<View>& views, const QualityOptions& options,
                                                        const WorkBudget& budget) {
  const auto context = make_context(options.device, camera.width, camera.height);
  Renderer renderer(*context, scene, camera);
  renderer.upload(shipped);
  const FramePair frames{{shipped.impostors.front().objects, {}}, {}, {{}, {0}}};
  std::vector<std::optional<CoveredError>> errors(views.size());
  const auto draw = [&](std::size_t i) {
    budget.report("quality: pictures", static_cast<double>(i) / static_cast<double>(views.size()));
    return draw_pair(renderer, views[i], frames, &FramePair::after);
  };
  compare_pairs(views.size(), options.threads, budget, draw,
                [&](std::size_t i, const PicturePair& pictures) { errors[i] = covered_error(pictures); });
  return errors;
}

std::optional<CoveredError> mean_of(std::span<const std::optional<CoveredError>> errors) {
  CoveredError sum;
  std::uint32_t compared = 0;
  for (const auto& error : errors) {
    if (!error) continue;
    sum.mean_error += error->mean_error;
    sum.mean_flip += error->mean_flip;
    ++compared;
  }
  if (compared == 0) return std::nullopt;
  return CoveredError{sum.mean_error / compared, sum.mean_flip / compared};
}

View from_reference(const ImpostorFrame& frame, const Vec3& target) {
  const Vec3 way = target - frame.reference_viewpoint;
  return {frame.reference_viewpoint, glm::length(way) > 0.0 ? glm::normalize(way) : frame.forward};
}

json number(const std::optional<double>& value) {
  return value ? json(*value) : json();
}

json error_json(const std::optional<CoveredError>& error) {
  return {{"mean_error", error ? json(error->mean_error) : json()}, {"mean_flip", error ? json(error->mean_flip) : json()}};
}

}  // namespace

ImpostorQuality judge_quality(const Scene& scene, const Impostor& baked, const std::string& glb, const Camera& camera, double alpha_rad,
                              const QualityOptions& options, const WorkBudget& budget) {
  const GlbQuads file = read_glb_quads(glb);
  const Box target = bounds_of(scene, baked.objects);
  std::vector<View> views = sample_cell_views(baked.view_cell, target, options.views, options.seed);
  ImpostorQuality quality;
  budget.report("quality: rays", 0.0);
  const auto judgements = judge_samplings(scene, file, judged(baked, alpha_rad), camera, views, kAlphaSamplings, options.threads, budget);
  std::ranges::copy(judgements, quality.by_sampling.begin());
  views.push_back(from_reference(baked.frame, target.centre()));
  const auto errors = covered_errors(scene, shipped_impostors(file, placement_of(baked)), camera, views, options, budget);
  quality.at_reference = errors.back();
  quality.over_views = mean_of(std::span(errors).first(options.views));
  return quality;
}

json quality_json(const ImpostorQuality& quality) {
  const ImpostorJudgement& nearest = quality.by_sampling.front();
  const double baseless =
      static_cast<double>(nearest.baseless_pixels) / static_cast<double>(std::max<std::uint64_t>(1, nearest.shown_pixels));
  json object = error_json(quality.over_views);
  object["at_reference"] = error_json(quality.at_reference);
  object["views"] = nearest.views;
  object["judged_pixels"] = nearest.pixels;
  object["gap_pixels"] = nearest.gap_pixels;
  object["max_parallax_ratio"] = nearest.max_parallax_ratio;
  object["baseless_pixel_share"] = nearest.shown_pixels > 0 ? json(baseless) : json();
  object["silhouette_bloat_px"] = number(nearest.bloat_px());
  for (std::size_t i = 0; i < kAlphaSamplings.size(); ++i)
    object["samplings"][std::string(sampling_name(kAlphaSamplings[i]))] = {
        {"gap_pixels", quality.by_sampling[i].gap_pixels}, {"silhouette_bloat_px", number(quality.by_sampling[i].bloat_px())}};
  return object;
}

}  // namespace standin
