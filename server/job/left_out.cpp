#include "server/job/left_out.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/trigonometric.hpp>

namespace standin {
namespace {

/// Greatest angle of a candidate's shaft against the horizontal.
double steepest_rad(const CandidateSet& candidates) {
  double steepest = 0.0;
  for (const auto& candidate : candidates.candidates)
    if (const auto* shaft = std::get_if<Shaft>(&candidate.view_cell))
      steepest = std::max(steepest, std::asin(std::min(1.0, std::abs(shaft->axis.y))));
  return steepest;
}

}  // namespace

void name_texturing_left_out(const Scene& scene, const JobSpec& spec, StageClock& clock) {
  const bool textured = std::ranges::any_of(scene.materials, [](const Material& material) { return material.texture >= 0; });
  if (!textured && !forced(spec, "bake")) clock.leave_out("bake", "filtering and sampling of textures: no material has one");
}

void name_culling_left_out(std::span<const Impostor> impostors, const JobSpec& spec, StageClock& clock) {
  const auto flat = std::ranges::count_if(impostors, [](const Impostor& impostor) { return impostor.layers.size() == 1; });
  if (flat == 0 || forced(spec, "bake")) return;
  clock.leave_out("bake", "culling between layers, for " + std::to_string(flat) + " of " + std::to_string(impostors.size()) +
                              " impostors: they have one layer");
}

void name_directions_left_out(const World& world, const CandidateSet& candidates, const JobSpec& spec, StageClock& clock) {
  const double height_m = world.view_space.bounds().size().y;
  if (height_m > world.view_space_options.leaf_m || spec.cell_shape != "shaft" || forced(spec, "candidates")) return;
  char reason[160];
  std::snprintf(reason, sizeof reason,
                "vertical shafts: a ground-level view space, %.1f m high, has one storey of cells; the steepest shaft has %.0f degrees",
                height_m, glm::degrees(steepest_rad(candidates)));
  clock.leave_out("candidates", reason);
}

}  // namespace standin
