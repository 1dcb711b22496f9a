// From a bake request to an impostor, and what one would cost before it is baked.
//
// A request names objects, a view cell and the quality; plan_impostor() chooses the reference viewpoint, resolution and layers (closed
// form, no rendering), bake() records, culls and cuts into quads (thesis 3.3-3.5). Both are pure functions: same request, same bytes, on
// any thread. No GL.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/base/work.h"
#include "render/impostor/impostor.h"
#include "render/impostor/layers.h"

namespace standin {

class TexturePyramids;  // texture_pyramid.h

struct BakeQuality {
  double alpha_scale = 1.0;  // parallax limit in units of the centre pixel's angle
  double texel_scale = 1.0;  // texel size in units of the centre pixel, at the nearest point of the view cell; > 0
  std::uint32_t max_layers = 200;
  std::uint32_t max_resolution = 4096;  // texels a side
  std::uint32_t grid_texels = 8;        // box growing (thesis 3.5)
  double fill_ratio = 0.8;
  bool fuzzy = false;      // masked surfaces without their outlines: no promise for what holds them (recorder.h, Coverage::kFuzzy)
  bool strict = true;      // layer set-up; false only for tests
  bool leave_out = true;   // what cannot change the result: culling of a single layer, texturing of untextured surfaces; false: for tests
  bool supercover = true;  // closed coverage; false (centre sampling) only for tests
  bool seal_rims = true;   // surfaces cover what any ray through them may pass on their layer (shift_bound.h); false: for tests and meshes
};

struct BakeRequest {
  std::vector<std::uint32_t> objects;  // ascending ids, at least one
  ViewCell view_cell;
};

/// Everything about an impostor that is known without recording.
struct ImpostorPlan {
  bool possible = false;
  const char* why_not = "";  // "cluster reaches into the view cell", "too many layers", "texture too large"
  ImpostorFrame frame;
  std::vector<Layer> layers;
  LayerSetup setup;
};

/// The objects' bounds are taken as one box in the frame of the view cell. Never throws for geometry: says why not.
[[nodiscard]] ImpostorPlan plan_impostor(const Box& object_bounds, const ViewCell& cell, const Camera& camera, const BakeQuality& quality);

/// The same where the objects' vertices are known: viewpoint as above, but texels and layers fit the points themselves, which rotated
/// boxes enclose only loosely. bake_layered plans this way.
[[nodiscard]] ImpostorPlan plan_impostor(const Box& object_bounds, std::span<const Vec3> points, const ViewCell& cell, const Camera& camera,
                                         const BakeQuality& quality);

/// The same question in O(1), for ranking: estimated number of layers and texture size. `layers` = infinity: impossible
/// or more than the quality allows.
struct ImpostorSketch {
  double layers = 0.0;
  double width_texels = 0.0;
  double height_texels = 0.0;
  double distance_m = 0.0;  // of the object's centre from the reference viewpoint
  ImpostorFrame frame;      // where possible
  double near_m = 0.0;      // depths along `forward` between which the layers lie
  double far_m = 0.0;
};
[[nodiscard]] ImpostorSketch sketch_impostor(const Box& object_bounds, const ViewCell& cell, const Camera& camera,
                                             const BakeQuality& quality);
/// Texels and layers for points (the objects' vertices, or a few that span as much), as bake_layered plans.
[[nodiscard]] ImpostorSketch sketch_impostor(const Box& object_bounds, std::span<const Vec3> points, const ViewCell& cell,
                                             const Camera& camera, const BakeQuality& quality);

/// Throws Failure(kImpostorImpossible) where plan_impostor says so. May return an impostor without quads (nothing visible).
[[nodiscard]] Impostor bake_layered(const Scene& scene, const BakeRequest& request, const Camera& camera, const BakeQuality& quality,
                                    const WorkBudget& budget = {});
/// The same with the scene's filtered textures, which many bakes, on any threads, share.
[[nodiscard]] Impostor bake_layered(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                                    const BakeQuality& quality, const WorkBudget& budget = {});

}  // namespace standin
