// Impostors as they ship: read back from the bytes of impostors.glb, so that what is drawn and judged is the file a renderer gets, not the
// structures that wrote it.
//
// The placement says which objects, view cell, frame and layers belong to an impostor; its quads, their places in the atlas and the texels
// come from the file alone. A mesh is taken as it is. Corners of quads are float offsets from the reference viewpoint: each is brought back
// to its layer and to integer texel coordinates, and a corner that is not on a layer or not on a texel's corner is an error, not a
// rounding.
#pragma once

#include <string>

#include "placement/runtime/placement.h"
#include "render/impostor/impostor.h"
#include "server/verify/glb_quads.h"

namespace standin {

/// Throws Failure(kFileBroken) naming the impostor and what does not fit. Quads come back page by page, so their order may differ.
[[nodiscard]] ImpostorSet shipped_impostors(const GlbQuads& glb, const Placement& placement);
/// From the bytes of the file.
[[nodiscard]] ImpostorSet read_shipped_impostors(const std::string& glb, const Placement& placement);

}  // namespace standin
