// Planar impostors (thesis 2.3.1, compared in 3.7): one textured plane, the cheapest thing to draw and the narrowest view cell.
//
// A planar impostor is a layered one whose set-up needs a single layer, so it keeps the layered impostor's promise. Where one plane is not
// enough for a view cell, several planar impostors share it: planar_requests() cuts the cell into parts that one plane each is enough for.
// A shaft is cut in its aperture, into equal angles, each part the shaft around its four corner rays; a box is cut per axis into equal
// boxes. Shafts are not cut in depth: they are open at the far end, so the nearest part would be the whole shaft again and need the same
// layers.
#pragma once

#include "render/impostor/bake.h"

namespace standin {

/// As bake_layered; throws Failure(kImpostorImpossible) as well where more than one layer is needed, and says how many.
[[nodiscard]] Impostor bake_planar(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                                   const BakeQuality& quality, const WorkBudget& budget = {});

/// The fewest parts of equal size whose impostors are planar; together they cover the view cell. Of cuts into equally many parts the first
/// one in order of the first axes' counts. Throws Failure(kImpostorImpossible) where that takes more than `max_parts`.
[[nodiscard]] std::vector<BakeRequest> planar_requests(const Scene& scene, const BakeRequest& request, const Camera& camera,
                                                       const BakeQuality& quality, std::uint32_t max_parts = 256);

}  // namespace standin
