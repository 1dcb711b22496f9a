// The smallest shaft around given cells.
//
// A candidate pays for its view cell in layers and texels, so after its cells are known the shaft shrinks to them: the axis is aimed at
// their middle, aperture and near plane touch the outermost corners. Halves the memory of a placement for nothing (simulation.md 5).
#pragma once

#include <optional>
#include <span>

#include "render/view/view_cell.h"

namespace standin {

/// Encloses every box, with a relative 1e-9 to spare for rounding. Nothing when some corner lies at or behind the apex.
[[nodiscard]] std::optional<Shaft> tight_shaft(const Vec3& apex, std::span<const Box> cells);

}  // namespace standin
