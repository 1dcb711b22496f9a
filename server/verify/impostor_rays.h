// Does an impostor keep its promise? Judged by rays against the original scene and against the GLB as written, whatever the technique.
//
// Gap pixel: the original covers the pixel and all pixels within 2 pixels of it, and the impostor there is transparent, or shows a point
// farther than the farthest original hit of that disc by more than the thickness of its layer's slab, along the ray. Parallax ratio: for a
// pixel that shows an opaque texel at Q, X is the original's point inside the layer's depth range on the ray from the reference viewpoint
// through Q; the ratio is the angle between X and Q seen from the viewpoint, over alpha. Coverage is closed, so that a texel may be opaque
// though the ray through Q itself passes its surface by up to one texel: then the surface found within one texel tells the depth of X,
// which stays on the ray (nearest-texel sampling shows it there). The promise is no gap pixel and a ratio of at most 1. Bloat: see
// silhouette.h.
//
// Layered impostors: a quad lies on its layer, whose slab and depth range are the layer's own. Meshes run through the layers: the
// depth range, and so the slab, is that of the layer whose range holds the depth of Q, extended by that of one neighbouring layer on either
// side; of several points X in it the one nearest in depth to Q counts (a layer records the first one in its slab).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/base/work.h"
#include "render/impostor/impostor.h"
#include "render/scene/scene.h"
#include "server/verify/alpha_sampling.h"
#include "server/verify/glb_quads.h"

namespace standin {

struct JudgedImpostor {
  std::string node;  // in the GLB
  std::vector<std::uint32_t> objects;
  std::vector<Layer> layers;  // distances from the reference viewpoint along `forward`, ascending
  Vec3 reference_viewpoint{0.0};
  Vec3 forward{0.0, 0.0, -1.0};
  ViewCell view_cell;
  double alpha_rad = 0.0;
  Technique technique = Technique::kLayered;
  // Of a texel of the reference viewpoint's image. Only meshes are looked at with it, whose own texels may lie along the view; layers tell.
  Vec2 slope_step{0.0};
};

struct ImpostorJudgement {
  std::uint32_t views = 0;
  std::uint64_t pixels = 0;  // covered by the original with their whole disc: those that could be gaps
  std::uint64_t gap_pixels = 0;
  std::uint64_t shown_pixels = 0;     // show an opaque texel
  std::uint64_t baseless_pixels = 0;  // of these, without any original within one texel in the layer's depth range: no ratio
  double max_parallax_ratio = 0.0;
  std::uint64_t excess_pixels = 0;  // show an opaque texel where the original covers nothing
  double silhouette_px = 0.0;       // length of the original's silhouette, over all views
  std::uint32_t worst_view = 0;     // index: most gap pixels, then greatest ratio

  /// Sums and greatest ratio of both; worst_view stays.
  void add(const ImpostorJudgement& other);
  /// Mean distance in pixels by which the silhouette exceeds the original's; none where no view shows a silhouette.
  [[nodiscard]] std::optional<double> bloat_px() const {
    return silhouette_px > 0.0 ? std::optional(static_cast<double>(excess_pixels) / silhouette_px) : std::nullopt;
  }
};

/// Views in the view cell that look at `target`, in equal parts from its corners (a shaft has four), all over its near border, along its
/// sides and deep inside.
[[nodiscard]] std::vector<View> sample_cell_views(const ViewCell& cell, const Box& target, std::uint32_t count, std::uint64_t seed);

/// At nearest-texel sampling. Only pixels within the projected bounds of the objects and the triangles are looked at. Independent of
/// `threads`. Throws Failure(kFileBroken) where a triangle reaches behind the reference viewpoint or, of a layered impostor, is not
/// parallel to its layer.
[[nodiscard]] ImpostorJudgement judge_impostor(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor,
                                               const Camera& camera, std::span<const View> views, int threads, const WorkBudget& budget);

/// The same under each of `samplings`, in their order, with one set of rays to the original for all.
[[nodiscard]] std::vector<ImpostorJudgement> judge_samplings(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor,
                                                             const Camera& camera, std::span<const View> views,
                                                             std::span<const AlphaSampling> samplings, int threads,
                                                             const WorkBudget& budget);

}  // namespace standin
