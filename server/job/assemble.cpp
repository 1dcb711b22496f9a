#include "server/job/assemble.h"

#include <algorithm>

#include "render/impostor/atlas.h"

namespace standin {
namespace {

// A cost in the linear form chosen for a region: where its pixels are capped, the cap is in the constant already.
double in_form(const Cost& cost, bool pixels_capped) {
  return pixels_capped ? cost.fixed_ms : cost.fixed_ms + cost.pixel_ms;
}

bool stands_for(const std::vector<BakedCandidate>& baked, std::span<const std::uint32_t> drawn, std::uint32_t object) {
  return std::ranges::any_of(drawn, [&](std::uint32_t i) { return std::ranges::binary_search(baked[i].impostor->objects, object); });
}

PlacementImpostor describe(const BakedCandidate& baked, const TimeModel& model, const Camera& camera) {
  const Impostor& impostor = *baked.impostor;
  PlacementImpostor described;
  described.objects = impostor.objects;
  described.view_cell = impostor.view_cell;
  described.frame = impostor.frame;
  described.layers = impostor.layers;
  described.technique = technique_name(impostor.technique);
  described.guarantee = guarantee_name(impostor);
  described.quads = static_cast<std::uint32_t>(baked.cost.quads);
  described.texels = static_cast<std::uint64_t>(baked.cost.texels);
  described.texture_bytes = texture_bytes(impostor);
  described.geometry_bytes = geometry_bytes(impostor);
  const Cost cost = model.cost(impostor_features_bound(baked.cost, camera));
  described.time_bound_ms = cost.fixed_ms + cost.pixel_ms;
  return described;
}

// Old indices of the impostors that some region draws, ascending.
std::vector<std::uint32_t> used_impostors(const std::vector<std::vector<std::uint32_t>>& assigned) {
  std::vector<std::uint32_t> used;
  for (const auto& drawn : assigned) used.insert(used.end(), drawn.begin(), drawn.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

std::vector<std::uint32_t> renumbered(const std::vector<std::uint32_t>& drawn, const std::vector<std::uint32_t>& kept) {
  std::vector<std::uint32_t> ids;
  for (const auto old : drawn) ids.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(kept, old) - kept.begin()));
  return ids;
}

}  // namespace

double predicted_after_ms(const Subdivision& subdivision, const Cpv& cpv, const std::vector<BakedCandidate>& baked,
                          std::span<const std::uint32_t> drawn, const TimeModel& model, const Camera& camera, double page_switch_ms) {
  double sum = cpv.constant_ms;
  for (std::uint64_t t = cpv.first_term; t < cpv.first_term + cpv.term_count; ++t)
    if (!stands_for(baked, drawn, subdivision.terms[t].object)) sum += subdivision.terms[t].predicted_ms;
  for (const auto i : drawn) sum += in_form(model.cost(impostor_features_bound(baked[i].cost, camera)), cpv.pixels_capped);
  return drawn.empty() ? sum : sum + page_switch_ms;
}

Placement assemble_placement(const Subdivision& subdivision, const ViewSpace& view_space, const std::vector<BakedCandidate>& baked,
                             const std::vector<std::vector<std::uint32_t>>& assigned, const TimeModel& model, const Camera& camera,
                             double budget_ms, double page_switch_ms, std::vector<std::uint32_t>& kept) {
  kept = used_impostors(assigned);
  Placement placement;
  placement.root_min = view_space.root_min;
  placement.root_side_m = view_space.root_side_m;
  placement.intervals = subdivision.intervals;
  placement.visible_sets = subdivision.visible_sets;
  for (const auto& cell : subdivision.cells) placement.cells.push_back({cell.key, cell.box, cell.visible_set});
  for (const auto old : kept) placement.impostors.push_back(describe(baked[old], model, camera));
  for (std::size_t p = 0; p < subdivision.cpvs.size(); ++p) {
    const Cpv& cpv = subdivision.cpvs[p];
    const double after_ms = model.bound_ms(predicted_after_ms(subdivision, cpv, baked, assigned[p], model, camera, page_switch_ms));
    placement.cpvs.push_back(
        {cpv.cell, cpv.interval, model.bound_ms(cpv.predicted_ms), after_ms, after_ms <= budget_ms, renumbered(assigned[p], kept)});
  }
  return placement;
}

}  // namespace standin
