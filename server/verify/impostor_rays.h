// Does an impostor keep its promise? Judged by rays against the original scene and against the GLB as written.
//
// Gap pixel: the original covers the pixel and all pixels within 2 pixels of it, and the impostor there is transparent, or shows a point
// farther than the farthest original hit of that disc by more than the thickness of its layer's slab. Parallax ratio: for a pixel that
// shows an opaque texel at Q, X is the original's point inside the layer's depth range on the ray from the reference viewpoint through Q;
// the ratio is the angle between X and Q seen from the viewpoint, over alpha. Coverage is closed, so that a texel may be opaque though the
// ray through Q itself passes its surface by up to one texel: then the surface found within one texel tells the depth of X, which stays on
// the ray (nearest-texel sampling shows it there). The promise is no gap pixel and a ratio of at most 1.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/base/work.h"
#include "render/impostor/impostor.h"
#include "render/scene/scene.h"
#include "server/verify/glb_quads.h"

namespace standin {

struct JudgedImpostor {
  std::string node;  // in the GLB
  std::vector<std::uint32_t> objects;
  std::vector<Layer> layers;  // distances from the reference viewpoint along `forward`
  Vec3 reference_viewpoint{0.0};
  Vec3 forward{0.0, 0.0, -1.0};
  ViewCell view_cell;
  double alpha_rad = 0.0;
};

struct ImpostorJudgement {
  std::uint32_t views = 0;
  std::uint64_t pixels = 0;  // covered by the original with their whole disc: those that could be gaps
  std::uint64_t gap_pixels = 0;
  std::uint64_t shown_pixels = 0;     // show an opaque texel
  std::uint64_t baseless_pixels = 0;  // of these, without any original within one texel in the layer's depth range: no ratio
  double max_parallax_ratio = 0.0;
  std::uint32_t worst_view = 0;  // index: most gap pixels, then greatest ratio
};

/// Views in the view cell that look at `target`, in equal parts from its corners (a shaft has four), all over its near border, along its
/// sides and deep inside.
[[nodiscard]] std::vector<View> sample_cell_views(const ViewCell& cell, const Box& target, std::uint32_t count, std::uint64_t seed);

/// Only pixels within the projected bounds of the objects and the quads are looked at. Independent of `threads`.
[[nodiscard]] ImpostorJudgement judge_impostor(const Scene& scene, const GlbQuads& quads, const JudgedImpostor& impostor,
                                               const Camera& camera, std::span<const View> views, int threads, const WorkBudget& budget);

}  // namespace standin
