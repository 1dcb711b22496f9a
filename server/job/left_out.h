// What baking and candidate generation leave out because of what a scene is, named for metrics.json (thesis: nothing; architecture.md:
// leave out what a scene does not need).
//
// The stages themselves decide (no texture: no texturing; one layer: no culling; directions come from the cells): these functions only say
// so, each unless the stage is forced to do it all the same.
#pragma once

#include <span>

#include "placement/candidates/candidates.h"
#include "server/job/world.h"

namespace standin {

/// No material has a texture: recording reads no texture coordinates, builds no filtered textures and samples none.
void name_texturing_left_out(const Scene& scene, const JobSpec& spec, StageClock& clock);
/// Impostors of one layer: nothing can hide behind another layer.
void name_culling_left_out(std::span<const Impostor> impostors, const JobSpec& spec, StageClock& clock);
/// A view space of one storey of cells: no shafts up or down, where no cell lies.
void name_directions_left_out(const World& world, const CandidateSet& candidates, const JobSpec& spec, StageClock& clock);

}  // namespace standin
