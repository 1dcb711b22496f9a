// Recording: which texels of which layer a set of objects covers, and in what colour (thesis 3.3.2).
//
// One pass over the triangles on the CPU. Each triangle is cut at the borders of the layers it reaches, and every texel whose closed square
// meets such a piece is drawn: with layers one texel of parallax apart this leaves no gap between them (math.md 1.7). In one texel of one
// layer a surface that holds the texel's centre wins over one that only touches the texel, and of two such the nearer; so a layer looks as
// if drawn by a graphics device, plus a rim.
//
// Masked surfaces are drawn where any part of the texel may be opaque, unless the coverage is fuzzy. Both faces of a surface are recorded
// even where a device would cull one: rays hit both, and what is hidden behind a front face is culled afterwards anyway.
#pragma once

#include <span>
#include <vector>

#include "render/base/work.h"
#include "render/impostor/impostor.h"
#include "render/impostor/layer_image.h"
#include "render/impostor/shift_bound.h"
#include "render/impostor/texture_pyramid.h"

namespace standin {

/// kFuzzy: closed but for masked surfaces, which are drawn only where a texel's centre meets an opaque point of theirs. On average that is
/// as much as there is to see, so leaves do not grow together; what the centres miss are gaps (thesis 3.7.1). kCentre is for tests.
enum class Coverage { kClosed, kFuzzy, kCentre };
/// kEverywhere, for tests: surfaces without texture are given one white texel and go the way of textured ones, to the same bytes.
enum class Texturing { kWhereTextured, kEverywhere };

/// With `shifts`, texels are drawn, too, that a ray through the surface may pass on the layer's plane, from anywhere in the view cell. So
/// every ray that meets a surface meets an opaque texel on the plane of its layer, whatever lies beside it. They give way to all that
/// touches the texel itself.
///
/// One image per layer, near to far. `layers` must not be empty; their ranges adjoin, and what lies before the first or beyond the last is
/// taken into that one. Every vertex must lie in front of the reference viewpoint.
[[nodiscard]] std::vector<LayerImage> record_layers(const Scene& scene, const TexturePyramids& textures,
                                                    std::span<const std::uint32_t> objects, const ImpostorFrame& frame,
                                                    std::span<const Layer> layers, Coverage coverage, const WorkBudget& budget = {},
                                                    Texturing texturing = Texturing::kWhereTextured, const ShiftBound* shifts = nullptr);

/// How far from the reference viewpoint, along `forward`, the surface in a recorded texel lies: at the texel's centre, or nearest to it.
[[nodiscard]] double depth_m(const RecordedTexel& texel, const Layer& layer);

}  // namespace standin
