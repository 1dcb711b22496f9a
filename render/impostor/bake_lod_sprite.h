// LOD-sprites (Chen, Swan, Kuo, Kaufman, VIS'99) as baked impostors: the image of the reference viewpoint on a coarse mesh of the objects.
//
// The paper draws the scene once, textures a low-resolution model with that image by projective texture mapping and goes on with it until
// the error criterion (1) fails. A baked impostor cannot be drawn again when it fails, so the criterion is asked beforehand, from all
// corners of the view cell: it decides how coarse the mesh may be (sprite_mesh.h). And a static file has no projective texturing: the image
// is resampled to charts in object space, one texel a pixel of the reference viewpoint (chart_texels.h), which any viewer shows right;
// plain triangles share a palette (sprite_palette.h). Triangles that no one in the view cell can face are dropped, and those that nobody
// is found to see (visible_surface.h); what the reference viewpoint does not see has its own surface's colour
// (sprite_colours.h).
//
// Nothing is promised (guarantee "none"). What is judged, original vertices and triangle centres, appears within alpha of its place from
// the reference viewpoint and the cell's corners; points between them and other viewpoints, deep in a shaft or inside a box, are not looked
// at. Disocclusion: detail that the mesh lacks is painted on what lies behind it, so it has no parallax of its own, and uncovers nothing as
// the viewer moves. Holes and outlines: the mesh may end inside the original's outline by a fraction of alpha, and open as narrow a gap
// where parts meet without sharing vertices. Masked surfaces, whose shape lies in their texture, are refused.
#pragma once

#include "render/impostor/bake.h"

namespace standin {

/// Throws as bake_layered does, and Failure(kImpostorImpossible) for a cluster with masked surfaces. May return a mesh without triangles
/// (nothing visible). `layers` are those a layered impostor would have: they are not drawn, but judges of depths use their ranges.
[[nodiscard]] Impostor bake_lod_sprite(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request,
                                       const Camera& camera, const BakeQuality& quality, const WorkBudget& budget = {});

}  // namespace standin
