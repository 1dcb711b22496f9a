// From what was chosen and baked to the placement that ships, with the bound of every region recomputed from its parts.
#pragma once

#include <span>
#include <vector>

#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "placement/view_space/subdivision.h"
#include "render/impostor/impostor.h"

namespace standin {

/// A baked impostor and what drawing it costs.
struct BakedCandidate {
  const Impostor* impostor = nullptr;
  ImpostorCost cost;
};

/// Predicted time of a CPV in its linear form when the given impostors replace the objects they stand for; summed in term order, then
/// impostor order. `page_switch_ms` is charged once per region that draws any impostor.
[[nodiscard]] double predicted_after_ms(const Subdivision& subdivision, const Cpv& cpv, const std::vector<BakedCandidate>& baked,
                                        std::span<const std::uint32_t> drawn, const TimeModel& model, const Camera& camera,
                                        double page_switch_ms);

/// `assigned[cpv]`: indices into `baked`, ascending. Impostors that no CPV draws are left out, the rest renumbered; `kept` receives their
/// old indices.
[[nodiscard]] Placement assemble_placement(const Subdivision& subdivision, const ViewSpace& view_space,
                                           const std::vector<BakedCandidate>& baked,
                                           const std::vector<std::vector<std::uint32_t>>& assigned, const TimeModel& model,
                                           const Camera& camera, double budget_ms, double page_switch_ms, std::vector<std::uint32_t>& kept);

}  // namespace standin
