// Which of a cluster's triangles anyone in the view cell sees: models of buildings are full of what nobody does.
//
// A low-resolution model in the paper's sense has no rooms behind its walls (VIS'99 simplifies outer surfaces); ours is made of whatever
// the objects hold. From the reference viewpoint and the view cell's corners, near and (for a shaft, which is open) far, depths are drawn
// at the centres of texels half as large as the impostor's; a triangle stays if from one of them a texel's centre or its own middle lies no
// deeper than what is drawn there, by two texels. That is a sample of the viewers: what others see alone is lost, as nothing of a
// LOD-sprite is promised.
#pragma once

#include "render/base/work.h"
#include "render/impostor/cluster_surface.h"

namespace standin {

/// The triangles of `surface` that are seen, in order; all where none is, so that there is something to show to who sees any. `frame`: of
/// the impostor, whose texels' size it goes by.
[[nodiscard]] std::vector<SurfaceTriangle> visible_surface(const Scene& scene, const std::vector<SurfaceTriangle>& surface,
                                                           const ViewCell& cell, const ImpostorFrame& frame, const WorkBudget& budget = {});

}  // namespace standin
