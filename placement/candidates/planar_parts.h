// Which parts of a set of cells a planar impostor each could serve, where one for all of them needs more layers (thesis 3.7.2).
//
// planar_requests() (bake_planar.h) cuts a view cell into parts of equal size, each with a plane of its own. Candidates serve whole cells
// of the view space, so the set of cells is halved instead, again and again until one layer is enough, at the middle angle of the wider
// side of its shaft. Like shafts there, sets are not cut in depth: the nearer part would need the same layers. A part is a candidate of its
// own, and the selection takes as many of them as it has use for.
#pragma once

#include <utility>

#include "placement/candidates/draft.h"

namespace standin {

/// Both parts of `cells` (at least one) as seen from the node's objects; the second is empty where they all lie in one direction.
[[nodiscard]] std::pair<CellSet, CellSet> halved_across(const DraftContext& context, std::uint32_t node, const CellSet& cells);

}  // namespace standin
