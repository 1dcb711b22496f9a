// The plain triangles of a LOD-sprite: one texel of a shared block for each colour.
//
// A mesh that follows its model to a pixel has many triangles of a pixel's width, and many models have few colours. A chart of one's own is
// mostly border there (some fifty texels for the least of them). A triangle that shows one colour wherever it is sampled, once a texel
// along its edges, has all its corners in the middle of that colour's texel instead, so that bilinear filtering shows it, too. Mipmaps mix
// it with its neighbours in the block, which come from near by on the mesh as a rule.
#pragma once

#include <optional>

#include "render/base/work.h"
#include "render/impostor/chart_texels.h"
#include "render/impostor/sprite_mesh.h"

namespace standin {

using PlainColour = std::optional<std::array<std::uint8_t, 4>>;  // nothing: not plain

/// Of each triangle. `on_lattice`: the same mesh, in half texels.
[[nodiscard]] std::vector<PlainColour> plain_colours(const SpriteMesh& mesh, const SimplifiedDepthMesh& on_lattice,
                                                     const SampleColour& colour, const WorkBudget& budget = {});

/// Appends the plain triangles to `chart`, with their block to `texels`. Nothing where there are none.
void append_palette(const SpriteMesh& mesh, std::span<const PlainColour> plain, TexturedMesh& chart, std::vector<std::uint8_t>& texels);

}  // namespace standin
