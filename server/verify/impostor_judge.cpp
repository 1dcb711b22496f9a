#include "server/verify/impostor_judge.h"

#include <algorithm>

#include "render/base/error.h"
#include "render/scene/object_bounds.h"
#include "server/verify/impostor_rays.h"

namespace standin {
namespace {

constexpr std::uint32_t kViewsPerImpostor = 4;  // one of each kind that sample_cell_views offers

bool promises(const PlacementImpostor& impostor) {
  return impostor.guarantee != "none";
}

std::vector<std::uint32_t> by_layer_count(const std::vector<PlacementImpostor>& impostors) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t id = 0; id < impostors.size(); ++id)
    if (promises(impostors[id])) order.push_back(id);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return impostors[a].layers.size() < impostors[b].layers.size(); });
  return order;
}

/// `wanted` of the order's entries, evenly spaced, the first and the last one included.
std::vector<std::uint32_t> evenly_spaced(const std::vector<std::uint32_t>& order, std::size_t wanted) {
  if (wanted >= order.size()) return order;
  if (wanted == 1) return {order.back()};
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(order[i * (order.size() - 1) / (wanted - 1)]);
  return chosen;
}

JudgedImpostor judged(const PlacementImpostor& placed, std::uint32_t id, double alpha_rad) {
  const auto technique = technique_named(placed.technique);
  if (!technique)
    throw Failure(ErrorWord::kFileBroken, "impostor " + std::to_string(id) + " is made by \"" + placed.technique + "\", unknown");
  return {"imp_" + std::to_string(id), placed.objects,   placed.layers, placed.frame.reference_viewpoint,
          placed.frame.forward,        placed.view_cell, alpha_rad,     *technique,
          placed.frame.slope_step};
}

}  // namespace

void judge_impostors(const VerifyInput& input, const GlbQuads& glb, const VerifyOptions& options, const WorkBudget& budget,
                     VerifyResult& result) {
  const auto& impostors = input.placement.impostors;
  if (impostors.empty() || options.judged_views == 0) {
    result.left_out.emplace_back(impostors.empty() ? "judging by rays: there is no impostor" : "judging by rays: no views were asked for");
    return;
  }
  const std::vector<std::uint32_t> promising = by_layer_count(impostors);
  if (promising.size() < impostors.size())
    result.left_out.push_back("judging by rays: " + std::to_string(impostors.size() - promising.size()) +
                              " fuzzy impostors, which promise nothing");
  if (promising.empty()) return;
  const std::size_t wanted = std::max(1U, options.judged_views / kViewsPerImpostor);
  ImpostorJudgement sum;
  const std::vector<std::uint32_t> chosen = evenly_spaced(promising, wanted);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    budget.check();
    budget.report("verify: rays", static_cast<double>(sum.views) / options.judged_views);
    const std::uint32_t id = chosen[i];
    const auto count =
        static_cast<std::uint32_t>(options.judged_views * (i + 1) / chosen.size() - options.judged_views * i / chosen.size());
    const auto views = sample_cell_views(impostors[id].view_cell, bounds_of(input.scene, impostors[id].objects), count, options.seed + id);
    const ImpostorJudgement judgement =
        judge_impostor(input.scene, glb, judged(impostors[id], id, input.alpha_rad), input.camera, views, options.threads, budget);
    sum.add(judgement);
  }
  result.judged_views = sum.views;
  result.gap_pixels = sum.gap_pixels;
  result.shown_pixels = sum.shown_pixels;
  result.baseless_pixels = sum.baseless_pixels;
  result.max_parallax_ratio = sum.max_parallax_ratio;
  result.silhouette_bloat_px = sum.bloat_px();
  if (chosen.size() < promising.size())
    result.left_out.push_back("judging by rays: a sample of " + std::to_string(chosen.size()) + " of " + std::to_string(promising.size()) +
                              " impostors");
}

}  // namespace standin
