#include "server/job/select_and_bake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "placement/candidates/selection_input.h"
#include "render/base/parallel.h"
#include "render/impostor/atlas.h"

namespace standin {
namespace {

double page_switches_ms(const TimeModel& model, std::uint32_t pages) {
  return pages * model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTextureSwitches)];
}

// Pages needed for so many bytes; the packing of the last round gives the real number.
std::uint32_t pages_for(double bytes) {
  const AtlasOptions options;
  const double page_bytes = 4.0 * options.max_side * options.max_side;
  constexpr double kPacked = 0.85;  // a page is filled at least so far
  return std::max(1U, static_cast<std::uint32_t>(std::ceil(bytes / (kPacked * page_bytes))));
}

// Keeps what was baked across rounds; candidate ids stay the same throughout.
class Baker {
 public:
  Baker(const World& world, const std::vector<Candidate>& candidates) : world_(world), candidates_(candidates), sizes_(candidates.size()) {}

  // Bakes those of `chosen` that are not baked yet. Returns how many.
  std::uint32_t bake(const std::vector<std::uint32_t>& chosen, const WorkBudget& budget) {
    std::vector<std::uint32_t> missing;
    for (const auto id : chosen)
      if (!baked_.contains(id)) missing.push_back(id);
    std::vector<Impostor> fresh(missing.size());
    std::atomic<std::size_t> done{0};
    parallel_for(missing.size(), world_.threads, budget, [&](std::size_t i) {
      const Candidate& candidate = candidates_[missing[i]];
      fresh[i] = bake_layered(world_.scene, {candidate.objects, candidate.view_cell}, world_.camera, world_.quality, budget);
      budget.report("bake", static_cast<double>(++done) / static_cast<double>(missing.size()));
    });
    for (std::size_t i = 0; i < missing.size(); ++i) keep(missing[i], std::move(fresh[i]));
    return static_cast<std::uint32_t>(missing.size());
  }

  [[nodiscard]] const Impostor& impostor(std::uint32_t candidate) const { return baked_.at(candidate); }
  [[nodiscard]] Impostor take(std::uint32_t candidate) { return std::move(baked_.at(candidate)); }

  [[nodiscard]] double bytes(const std::vector<std::uint32_t>& chosen) const {
    double sum = 0.0;
    for (const auto id : chosen) sum += sizes_[id] ? sizes_[id]->bytes : candidates_[id].bytes;
    return sum;
  }
  /// Real bytes and costs, per candidate.
  [[nodiscard]] const std::vector<std::optional<BakedSize>>& sizes() const { return sizes_; }

 private:
  void keep(std::uint32_t id, Impostor impostor) {
    sizes_[id] = BakedSize{std::max(1.0, static_cast<double>(texture_bytes(impostor))), impostor_cost(impostor)};
    baked_.emplace(id, std::move(impostor));
  }

  const World& world_;
  const std::vector<Candidate>& candidates_;
  std::vector<std::optional<BakedSize>> sizes_;
  std::map<std::uint32_t, Impostor> baked_;
};

// CPVs whose real bound misses the budget although the selection called them met.
std::uint32_t count_short(const Subdivision& subdivision, const Selection& selection, const Baker& baker, const World& world,
                          const TimeModel& model, double budget_ms, double page_switch_ms) {
  std::vector<bool> unmet(subdivision.cpvs.size(), false);
  for (const auto& shortfall : selection.summary.unmet) unmet[shortfall.cpv] = true;
  std::uint32_t count = 0;
  std::vector<BakedCandidate> drawn;
  std::vector<std::uint32_t> all;
  for (std::size_t p = 0; p < subdivision.cpvs.size(); ++p) {
    if (unmet[p]) continue;
    drawn.clear();
    all.clear();
    for (const auto id : selection.assigned[p]) {
      all.push_back(static_cast<std::uint32_t>(drawn.size()));
      drawn.push_back({&baker.impostor(id), baker.sizes()[id]->cost});
    }
    const double after_ms = predicted_after_ms(subdivision, subdivision.cpvs[p], drawn, all, model, world.camera, page_switch_ms);
    count += model.bound_ms(after_ms) > budget_ms ? 1 : 0;
  }
  return count;
}

void collect(SelectedImpostors& result, Baker& baker) {
  std::map<std::uint32_t, std::uint32_t> position;
  for (const auto id : result.selection.chosen) {
    position[id] = static_cast<std::uint32_t>(result.impostors.size());
    result.impostors.push_back(baker.take(id));
  }
  for (std::size_t i = 0; i < result.impostors.size(); ++i)
    result.baked.push_back({&result.impostors[i], baker.sizes()[result.selection.chosen[i]]->cost});
  for (const auto& antichain : result.selection.assigned) {
    std::vector<std::uint32_t> drawn;
    for (const auto id : antichain) drawn.push_back(position.at(id));
    std::ranges::sort(drawn);
    result.assigned.push_back(std::move(drawn));
  }
}

}  // namespace

SelectedImpostors select_and_bake(const World& world, const Subdivision& subdivision, const CandidateSet& candidates,
                                  const TimeModel& model, double budget_ms, const JobSpec& spec, StageClock& clock,
                                  const WorkBudget& budget) {
  Baker baker(world, candidates.candidates);
  SelectedImpostors result;
  result.atlas_pages = 1;
  for (int round = 1;; ++round) {
    const bool last = round >= spec.bake_rounds;
    result.page_switch_ms = page_switches_ms(model, result.atlas_pages);
    clock.run("select", [&] {
      const SelectionBudget limits{model.predicted_budget_ms(budget_ms), result.page_switch_ms};
      const SelectionProblem problem = make_selection_problem(world.hierarchy, subdivision, candidates, baker.sizes(), model, world.camera,
                                                              limits, world.threads, budget);
      SelectionConfig config;
      config.exchange_rounds = spec.exchange_rounds;
      config.bound_iterations = spec.bound_iterations;
      result.selection = select_impostors(problem, config, result.selection.chosen, budget);
    });
    BakeRound outcome;
    outcome.estimated_bytes = baker.bytes(result.selection.chosen);
    outcome.baked = clock.run("bake", [&] { return baker.bake(result.selection.chosen, budget); });
    outcome.real_bytes = baker.bytes(result.selection.chosen);
    const std::uint32_t pages = pages_for(outcome.real_bytes);
    outcome.short_cpvs = count_short(subdivision, result.selection, baker, world, model, budget_ms, page_switches_ms(model, pages));
    result.rounds.push_back(outcome);
    const bool settled = outcome.baked == 0 && outcome.short_cpvs == 0 && pages <= result.atlas_pages;
    result.atlas_pages = std::max(pages, result.atlas_pages);
    if (last || settled || result.selection.chosen.empty()) break;
  }
  result.page_switch_ms = page_switches_ms(model, result.atlas_pages);
  collect(result, baker);
  return result;
}

}  // namespace standin
