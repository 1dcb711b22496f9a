#include "server/job/select_and_bake.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "placement/candidates/selection_input.h"
#include "render/base/parallel.h"
#include "render/impostor/atlas.h"
#include "render/impostor/size_bound.h"
#include "server/job/baker.h"

namespace standin {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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

// How far estimates were off where they could be compared. What is chosen next is what looks cheapest, so the median would be too small
// (the winner's curse): three of four bakes stay below the factor for bytes. Costs take more caution, 19 of 20, since each that comes out
// dearer leaves regions short and asks for another round.
struct Correction {
  double bytes = 1.0;
  double quads = 1.0;
  double texels = 1.0;  // of texels times their solid angle, which is what is paid for
};

constexpr double kBytesShare = 0.75;
constexpr double kCostShare = 0.95;
constexpr std::size_t kCarefulRounds = 2;  // after so many, the greatest factor seen
// Once all else is settled, regions that nothing solves by such costs are tried with ever less caution.
constexpr std::array<double, 3> kBoldCostShares = {0.95, 0.75, 0.5};
// That goes on while it is cheap: an impossible budget would bake ever more that is of no use.
constexpr std::size_t kBoldRounds = 3;    // at least
constexpr double kCheapBoldShare = 0.01;  // of all bakes so far

double quantile(std::vector<double> ratios, double share) {
  const auto position = ratios.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(ratios.size() - 1));
  std::nth_element(ratios.begin(), position, ratios.end());
  return *position;
}

double pixels_of(const ImpostorCost& cost) {
  return cost.texels * cost.texel_angle_rad * cost.texel_angle_rad;
}

// One for each technique.
using Corrections = std::array<Correction, kTechniqueCount>;

Correction& of(Corrections& corrections, Technique technique) {
  return corrections.at(static_cast<std::size_t>(technique));
}

// `unknown`: where there is nothing to compare.
Correction compare(const std::vector<Candidate>& estimated, const std::vector<std::optional<BakedSize>>& real, Technique technique,
                   double cost_share, const Correction& unknown) {
  std::vector<double> bytes, quads, texels;
  for (std::size_t id = 0; id < estimated.size(); ++id) {
    if (estimated[id].technique != technique || !real[id] || !real[id]->possible || !(pixels_of(estimated[id].cost) > 0.0) ||
        !(estimated[id].cost.quads > 0.0))
      continue;
    bytes.push_back(real[id]->bytes / estimated[id].bytes);
    quads.push_back(real[id]->cost.quads / estimated[id].cost.quads);
    texels.push_back(pixels_of(real[id]->cost) / pixels_of(estimated[id].cost));
  }
  if (bytes.empty()) return unknown;
  return {quantile(bytes, kBytesShare), quantile(quads, cost_share), quantile(texels, cost_share)};
}

Corrections compare_all(const std::vector<Candidate>& estimated, const std::vector<std::optional<BakedSize>>& real, double cost_share,
                        const Corrections& unknown) {
  Corrections corrections;
  for (std::size_t t = 0; t < kTechniqueCount; ++t)
    corrections[t] = compare(estimated, real, static_cast<Technique>(t), cost_share, unknown[t]);
  return corrections;
}

Corrections margins_of(const SizeModels& sizes) {
  Corrections margins;
  for (std::size_t t = 0; t < kTechniqueCount; ++t) {
    const auto technique = static_cast<Technique>(t);
    if (!sizes.offers(technique)) continue;
    const SizeModel& model = sizes.of(technique);
    margins[t] = {1.0, model.quads_margin, model.texels_margin};
  }
  return margins;
}

ImpostorCost corrected(const ImpostorCost& cost, const Correction& by) {
  return {cost.quads * by.quads, cost.texels * by.texels, cost.texel_angle_rad};
}

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

// The rounds of one job.
class Rounds {
 public:
  Rounds(const World& world, const Subdivision& subdivision, const CandidateSet& candidates, const SizeModels& sizes,
         const TimeModel& model, double budget_ms, BakeMemory* bakes, const WorkBudget& budget)
      : world_(world),
        subdivision_(subdivision),
        candidates_(candidates),
        model_(model),
        budget_ms_(budget_ms),
        budget_(budget),
        margins_(margins_of(sizes)),
        baker_(world, candidates.candidates, bakes) {
    result_.atlas_pages = 1;
    result_.page_switch_ms = page_switches_ms(model_, 1);
    problem_ = make_selection_problem(world.hierarchy, subdivision, candidates, model, world.camera, limits(), world.threads, budget);
    update(margins_);
  }

  void select(const JobSpec& spec) {
    SelectionConfig config;
    config.reverse_delete = !spec.keep_picks;
    config.guided_sweeps = spec.guided_sweeps;
    config.exchange_rounds = spec.exchange_rounds;
    config.recreate_trials = spec.recreate_trials;
    config.bound_iterations = 0;
    config.threads = world_.threads;
    const auto start = std::chrono::steady_clock::now();
    if (spec.work_limit_gains > 0) config.most_gains = spec.work_limit_gains;
    config.gains_before = result_.gains;
    if (spec.deadline_s > 0.0)
      config.out_of_time = [start, rest_s = spec.deadline_s - selecting_s_] { return seconds_since(start) >= rest_s; };
    const bool is_first = result_.rounds.empty();
    if (is_first) config.on_step = [&](const SelectionStep& step) { result_.first_steps.push_back({step, seconds_since(start)}); };
    result_.selection = select_impostors(problem_, config, result_.selection.chosen, budget_);
    selecting_s_ += seconds_since(start);
    if (is_first) result_.first_bound_bytes = result_.selection.summary.priced_bound_bytes;
    note_limits();
  }

  // True when what is selected is baked, and holds, and there is nothing left to try.
  bool bake() {
    BakeRound outcome;
    outcome.estimated_bytes = baker_.bytes(result_.selection.chosen);
    outcome.baked = baker_.bake(result_.selection.chosen, budget_);
    outcome.real_bytes = baker_.bytes(result_.selection.chosen);
    reserve_pages();
    outcome.short_cpvs =
        count_short(subdivision_, result_.selection, baker_, world_, model_, budget_ms_, page_switches_ms(model_, result_.atlas_pages));
    result_.rounds.push_back(outcome);
    tell_best(outcome.real_bytes, outcome.short_cpvs);
    const bool settled = outcome.baked == 0 && outcome.short_cpvs == 0;
    const bool done = settled && (result_.selection.summary.unmet.empty() || boldness_ == kBoldCostShares.size());
    if (settled && !done) ++boldness_;
    update(compare_all(candidates_.candidates, baker_.sizes(), cost_share(), boldness_ > 0 ? Corrections{} : margins_));
    return done || (boldness_ > 0 && enough_boldness(outcome.baked));
  }

  [[nodiscard]] bool is_short() const { return result_.rounds.back().short_cpvs > 0; }

  // The best that can be done with what is baked: where the rounds end before real bakes agree with the estimates.
  void select_among_baked(const JobSpec& spec) {
    std::vector<Shortfall> short_of_all = std::move(result_.selection.summary.unmet);
    do {
      update({});
      for (std::uint32_t id = 0; id < candidates_.candidates.size(); ++id)
        if (!baker_.sizes()[id]) rule_out(problem_, id);
      select(spec);
    } while (reserve_pages());
    result_.only_baked = true;
    keep_residuals(short_of_all);
  }

  SelectedImpostors finish(int bound_iterations) {
    SelectionSummary& summary = result_.selection.summary;
    summary.bytes = baker_.bytes(result_.selection.chosen);
    tell_best(summary.bytes, 0);
    const SelectionConfig config{.bound_iterations = bound_iterations, .threads = world_.threads};
    if (bound_iterations > 0) {
      spend_nothing_on_unmet();
      for (const auto id : result_.selection.chosen) result_.as_selected.bytes += problem_.bytes[id];
      result_.as_selected.lower_bound_bytes = memory_lower_bound(problem_, result_.selection, config, budget_);
    }
    update({});
    result_.shown = show_fewest(problem_, result_.selection, budget_);
    if (bound_iterations > 0) {
      spend_nothing_on_unmet();
      set_least_bytes();
      summary.lower_bound_bytes = memory_lower_bound(problem_, result_.selection, config, budget_);
    }
    collect(result_, baker_);
    return std::move(result_);
  }

 private:
  // What would be placed if the rounds ended now.
  void tell_best(double bytes, std::size_t short_cpvs) const {
    budget_.found({{"texture_bytes", bytes},
                   {"impostors", static_cast<double>(result_.selection.chosen.size())},
                   {"unsolved_cpvs", static_cast<double>(result_.selection.summary.unmet.size() + short_cpvs)}});
  }

  [[nodiscard]] SelectionBudget limits() const { return {model_.predicted_budget_ms(budget_ms_), result_.page_switch_ms}; }

  void note_limits() {
    const SelectionSummary& summary = result_.selection.summary;
    result_.gains += summary.gains;
    result_.evaluations += summary.evaluations;
    result_.picked_by_greedy += summary.picked_by_greedy;
    result_.stalled += summary.stalled;
    if (summary.cut_short.empty() || (!result_.limits.empty() && result_.limits.back() == summary.message)) return;
    result_.limits.push_back(summary.message);
  }

  // A bound spends nothing on them, as the selection does.
  void spend_nothing_on_unmet() {
    for (const Shortfall& shortfall : result_.selection.summary.unmet) problem_.deficit[shortfall.cpv] = 0.0;
  }

  // For the certificate: real bytes of what was baked, and no more than any bake could give of the rest.
  void set_least_bytes() {
    constexpr double kNothingProven = 1.0;  // a bake without quads is taken for as much
    const SizeBound bound(world_.scene);
    parallel_for(candidates_.candidates.size(), world_.threads, budget_, [&](std::size_t id) {
      if (baker_.sizes()[id]) return;
      const Candidate& candidate = candidates_.candidates[id];
      // Nothing is proven of a mesh's size.
      const double least =
          is_mesh(candidate.technique) ? 0.0 : bound.texture_bytes(candidate.objects, candidate.view_cell, world_.camera, world_.quality);
      problem_.bytes[id] = std::max(kNothingProven, least);
    });
  }

  // Whether what is chosen fills more atlas pages than any choice so far.
  bool reserve_pages() {
    const std::uint32_t pages = pages_for(baker_.bytes(result_.selection.chosen));
    const bool more = pages > result_.atlas_pages;
    result_.atlas_pages = std::max(pages, result_.atlas_pages);
    return more;
  }

  // A region that no candidates could solve is short by what the best of all leave, not by what those leave that happen to be baked.
  void keep_residuals(const std::vector<Shortfall>& short_of_all) {
    std::map<std::uint32_t, double> residual;
    for (const Shortfall& shortfall : short_of_all) residual[shortfall.cpv] = shortfall.residual;
    for (Shortfall& shortfall : result_.selection.summary.unmet)
      if (const auto known = residual.find(shortfall.cpv); known != residual.end())
        shortfall.residual = std::min(shortfall.residual, known->second);
  }

  // Costs of what is not baked are estimated with caution, so that few bakes leave a region short: the share of bakes that stay below.
  [[nodiscard]] double cost_share() const {
    if (boldness_ > 0) return kBoldCostShares[boldness_ - 1];
    return result_.rounds.size() < kCarefulRounds ? kCostShare : 1.0;
  }

  // `baked`: in the round just done.
  [[nodiscard]] bool enough_boldness(std::uint32_t baked) {
    return bold_rounds_++ >= kBoldRounds && baked > kCheapBoldShare * static_cast<double>(baker_.count());
  }

  // The same problem with what is baked as it is, and the rest as estimated with a correction.
  void update(Corrections corrections) {
    result_.page_switch_ms = page_switches_ms(model_, result_.atlas_pages);
    set_budget(problem_, subdivision_, limits());
    for (std::uint32_t id = 0; id < candidates_.candidates.size(); ++id) {
      const Candidate& estimate = candidates_.candidates[id];
      const auto& real = baker_.sizes()[id];
      const Correction& correction = of(corrections, estimate.technique);
      if (!real)
        set_impostor(problem_, id, correction.bytes * estimate.bytes, corrected(estimate.cost, correction), model_, world_.camera);
      else if (real->possible)
        set_impostor(problem_, id, real->bytes, real->cost, model_, world_.camera);
      else
        rule_out(problem_, id);
    }
  }

  const World& world_;
  const Subdivision& subdivision_;
  const CandidateSet& candidates_;
  const TimeModel& model_;
  double budget_ms_;
  const WorkBudget& budget_;
  const Corrections margins_;
  Baker baker_;
  SelectionProblem problem_;
  std::size_t boldness_ = 0;  // how often caution was given up
  std::size_t bold_rounds_ = 0;
  double selecting_s_ = 0.0;  // wall seconds of all selections
  SelectedImpostors result_;
};

}  // namespace

SelectedImpostors select_and_bake(const World& world, const Subdivision& subdivision, const CandidateSet& candidates,
                                  const SizeModels& sizes, const TimeModel& model, double budget_ms, const JobSpec& spec, BakeMemory* bakes,
                                  StageClock& clock, const WorkBudget& budget) {
  auto rounds = clock.run("select", [&] { return Rounds(world, subdivision, candidates, sizes, model, budget_ms, bakes, budget); });
  for (int round = 0; round < spec.bake_rounds; ++round) {
    clock.run("select", [&] { rounds.select(spec); });
    if (clock.run("bake", [&] { return rounds.bake(); })) break;
  }
  if (rounds.is_short()) {
    clock.run("select", [&] { rounds.select_among_baked(spec); });
    clock.run("bake", [&] { return rounds.bake(); });
  }
  return clock.run("select", [&] { return rounds.finish(spec.bound_iterations); });
}

}  // namespace standin
