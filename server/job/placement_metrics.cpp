#include "server/job/placement_metrics.h"

#include <algorithm>
#include <string>

#include "render/impostor/atlas.h"

namespace standin {
namespace {

using nlohmann::json;

// The selection speaks of the candidates and costs it was given.
std::string select_message(const SelectedImpostors& selected) {
  std::string message = selected.selection.summary.message;
  if (selected.only_baked && !selected.selection.summary.unmet.empty()) message += " that were baked when the rounds ended";
  const std::uint32_t short_cpvs = selected.rounds.empty() ? 0 : selected.rounds.back().short_cpvs;
  if (short_cpvs > 0) message += "; " + std::to_string(short_cpvs) + " more fell short once baked";
  return message;
}

}  // namespace

json cpv_json(const Placement& placement) {
  const auto solved = static_cast<std::uint64_t>(std::ranges::count_if(placement.cpvs, [](const auto& cpv) { return cpv.solved; }));
  return {{"count", placement.cpvs.size()}, {"solved", solved}, {"unsolved", placement.cpvs.size() - solved}};
}

json candidates_json(const CandidateSet& candidates) {
  return {{"generated", candidates.generated},
          {"kept", candidates.candidates.size()},
          {"pruned", candidates.generated - candidates.candidates.size()},
          {"duplicates", candidates.duplicates},
          {"impossible", candidates.impossible},
          {"hopeless", candidates.hopeless}};
}

json impostor_counts(const Placement& placement) {
  json counts = {{"count", placement.impostors.size()}, {"by_technique", json::object()}};
  for (const auto& impostor : placement.impostors) {
    json& count = counts["by_technique"][impostor.technique];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return counts;
}

json select_metrics(const SelectedImpostors& selected, const Placement& placement) {
  json rounds = json::array();
  for (const auto& round : selected.rounds)
    rounds.push_back({{"baked", round.baked},
                      {"short_cpvs", round.short_cpvs},
                      {"estimated_bytes", round.estimated_bytes},
                      {"real_bytes", round.real_bytes}});
  const SelectionSummary& summary = selected.selection.summary;
  return {{"message", select_message(selected)},
          {"picked_by_greedy", selected.picked_by_greedy},
          {"stalled", selected.stalled},
          {"evaluations", selected.evaluations},
          {"gains", selected.gains},
          {"limits", selected.limits},
          {"bytes_greedy", summary.bytes_greedy},
          {"impostors", placement.impostors.size()},
          {"assignments", {{"most_gain", selected.shown.before}, {"fewest", selected.shown.after}}},
          {"rounds", std::move(rounds)}};
}

json memory_json(const Placed& placed, const LodFigures& lods) {
  std::uint64_t texture = 0, geometry = 0;
  const std::uint64_t of_levels = placed.shows_levels ? lods.file.buffer_bytes : 0;
  for (const auto& impostor : placed.placement.impostors) {
    texture += impostor.texture_bytes;
    geometry += impostor.geometry_bytes;
  }
  return {{"texture_bytes", texture},
          {"geometry_bytes", geometry},
          {"lods_bytes", of_levels},
          {"total_bytes", texture + geometry + of_levels},
          {"atlas_padding_bytes", padding_bytes(placed.set)}};
}

json bound_json(const SelectedImpostors& selected) {
  const auto gap = [](double bytes, double bound) { return bytes > 0.0 ? (bytes - bound) / bytes : 0.0; };
  const SelectionSummary& summary = selected.selection.summary;
  const BoundAsSelected& as_selected = selected.as_selected;
  return {
      {"memory_lower_bound_bytes", summary.lower_bound_bytes},
      {"gap", gap(summary.bytes, summary.lower_bound_bytes)},
      {"selection_lower_bound_bytes", as_selected.lower_bound_bytes},
      {"selection_gap", gap(as_selected.bytes, as_selected.lower_bound_bytes)},
      {"selection_gap_holds_for",
       "the same at the bytes and drawing times that the selection knew: real where a candidate was baked, estimated where not; how much a "
       "better choice could save if these are right, while `gap` is proven"},
      {"holds_for",
       "this candidate set, these CPVs and this time bound; bytes are real where a candidate was baked and a proven lower bound where not, "
       "drawing times of those that were not baked are estimates"}};
}

}  // namespace standin
