#include "server/job/select_and_bake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "placement/candidates/selection_input.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/impostor/atlas.h"
#include "render/impostor/texture_pyramid.h"

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

// What is known of a candidate once it is baked.
struct BakedSize {
  double bytes = 0.0;  // > 0
  ImpostorCost cost;
};

// What cannot be baked costs more than anything: it gains nowhere, and the next round lets go of it.
constexpr BakedSize kImpossible{1e15, {1e15, 1e15, 1.0}};

// Keeps what was baked across rounds; candidate ids stay the same throughout.
class Baker {
 public:
  Baker(const World& world, const std::vector<Candidate>& candidates)
      : world_(world), textures_(world.scene), candidates_(candidates), sizes_(candidates.size()) {}

  // Bakes those of `chosen` that are not baked yet. Returns how many.
  std::uint32_t bake(const std::vector<std::uint32_t>& chosen, const WorkBudget& budget) {
    std::vector<std::uint32_t> missing;
    for (const auto id : chosen)
      if (!baked_.contains(id)) missing.push_back(id);
    std::vector<std::optional<Impostor>> fresh(missing.size());
    std::atomic<std::size_t> done{0};
    parallel_for(missing.size(), world_.threads, budget, [&](std::size_t i) {
      fresh[i] = try_bake(candidates_[missing[i]], budget);
      budget.report("bake", static_cast<double>(++done) / static_cast<double>(missing.size()));
    });
    for (std::size_t i = 0; i < missing.size(); ++i) keep(missing[i], std::move(fresh[i]));
    return static_cast<std::uint32_t>(missing.size());
  }

  [[nodiscard]] std::size_t count() const { return baked_.size(); }
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
  // Nothing where the sketch was too hopeful: the recorded vertices need more layers than allowed.
  [[nodiscard]] std::optional<Impostor> try_bake(const Candidate& candidate, const WorkBudget& budget) const {
    try {
      return bake_layered(world_.scene, textures_, {candidate.objects, candidate.view_cell}, world_.camera, world_.quality, budget);
    } catch (const Failure& failure) {
      if (failure.word() != ErrorWord::kImpostorImpossible) throw;
      return std::nullopt;
    }
  }

  void keep(std::uint32_t id, std::optional<Impostor> impostor) {
    sizes_[id] = kImpossible;
    if (impostor) sizes_[id] = BakedSize{std::max(1.0, static_cast<double>(texture_bytes(*impostor))), impostor_cost(*impostor)};
    baked_.emplace(id, impostor ? std::move(*impostor) : Impostor{});
  }

  const World& world_;
  const TexturePyramids textures_;
  const std::vector<Candidate>& candidates_;
  std::vector<std::optional<BakedSize>> sizes_;
  std::map<std::uint32_t, Impostor> baked_;
};

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

double quantile(std::vector<double> ratios, double share) {
  if (ratios.empty()) return 1.0;
  const auto position = ratios.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(ratios.size() - 1));
  std::nth_element(ratios.begin(), position, ratios.end());
  return *position;
}

double pixels_of(const ImpostorCost& cost) {
  return cost.texels * cost.texel_angle_rad * cost.texel_angle_rad;
}

Correction compare(const std::vector<Candidate>& estimated, const std::vector<std::optional<BakedSize>>& real, double cost_share) {
  std::vector<double> bytes, quads, texels;
  for (std::size_t id = 0; id < estimated.size(); ++id) {
    if (!real[id] || real[id]->bytes == kImpossible.bytes || !(pixels_of(estimated[id].cost) > 0.0) || !(estimated[id].cost.quads > 0.0))
      continue;
    bytes.push_back(real[id]->bytes / estimated[id].bytes);
    quads.push_back(real[id]->cost.quads / estimated[id].cost.quads);
    texels.push_back(pixels_of(real[id]->cost) / pixels_of(estimated[id].cost));
  }
  return {quantile(bytes, kBytesShare), quantile(quads, cost_share), quantile(texels, cost_share)};
}

ImpostorCost corrected(const ImpostorCost& cost, const Correction& by) {
  return {cost.quads * by.quads, cost.texels * by.texels, cost.texel_angle_rad};
}

// Rounds without caution go on while they are cheap: an impossible budget would bake ever more that is of no use.
constexpr std::size_t kBoldRounds = 3;    // at least
constexpr double kCheapBoldShare = 0.01;  // of all bakes so far

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
  Rounds(const World& world, const Subdivision& subdivision, const CandidateSet& candidates, const SizeModel& sizes, const TimeModel& model,
         double budget_ms, const WorkBudget& budget)
      : world_(world),
        subdivision_(subdivision),
        candidates_(candidates),
        sizes_(sizes),
        model_(model),
        budget_ms_(budget_ms),
        budget_(budget),
        baker_(world, candidates.candidates) {
    result_.atlas_pages = 1;
    result_.page_switch_ms = page_switches_ms(model_, 1);
    problem_ = make_selection_problem(world.hierarchy, subdivision, candidates, model, world.camera, limits(), world.threads, budget);
  }

  void select(const JobSpec& spec) {
    SelectionConfig config;
    config.exchange_rounds = spec.exchange_rounds;
    config.bound_iterations = 0;
    config.threads = world_.threads;
    result_.selection = select_impostors(problem_, config, result_.selection.chosen, budget_);
  }

  // True when what is selected is baked, and holds, and there is nothing left to try.
  bool bake() {
    const std::vector<std::uint32_t>& chosen = result_.selection.chosen;
    BakeRound outcome;
    outcome.estimated_bytes = baker_.bytes(chosen);
    outcome.baked = baker_.bake(chosen, budget_);
    outcome.real_bytes = baker_.bytes(chosen);
    const std::uint32_t pages = pages_for(outcome.real_bytes);
    outcome.short_cpvs = count_short(subdivision_, result_.selection, baker_, world_, model_, budget_ms_, page_switches_ms(model_, pages));
    result_.rounds.push_back(outcome);
    const bool settled = outcome.short_cpvs == 0 && pages <= result_.atlas_pages;
    result_.atlas_pages = std::max(pages, result_.atlas_pages);
    bool done = chosen.empty() || (settled && outcome.baked == 0);
    if (done && cautious_ && !result_.selection.summary.unmet.empty()) {
      cautious_ = false;
      done = false;
    }
    const double cost_share = result_.rounds.size() < kCarefulRounds ? kCostShare : 1.0;
    update(cautious_ ? compare(candidates_.candidates, baker_.sizes(), cost_share) : without_caution());
    return done || (!cautious_ && enough_boldness(outcome.baked));
  }

  SelectedImpostors finish(int bound_iterations) {
    SelectionSummary& summary = result_.selection.summary;
    summary.bytes = baker_.bytes(result_.selection.chosen);
    if (bound_iterations > 0) {
      update(without_caution());
      const SelectionConfig config{.bound_iterations = bound_iterations, .threads = world_.threads};
      summary.lower_bound_bytes = memory_lower_bound(problem_, summary.bytes, config, budget_);
    }
    collect(result_, baker_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] SelectionBudget limits() const { return {model_.predicted_budget_ms(budget_ms_), result_.page_switch_ms}; }

  [[nodiscard]] Correction without_caution() const { return {1.0, 1.0 / sizes_.quads_margin, 1.0 / sizes_.bytes_margin}; }

  // `baked`: in the round just done.
  [[nodiscard]] bool enough_boldness(std::uint32_t baked) {
    return bold_rounds_++ >= kBoldRounds && baked > kCheapBoldShare * static_cast<double>(baker_.count());
  }

  // The same problem with what is baked as it is, and the rest as estimated with a correction.
  void update(const Correction& correction) {
    result_.page_switch_ms = page_switches_ms(model_, result_.atlas_pages);
    set_budget(problem_, subdivision_, limits());
    for (std::uint32_t id = 0; id < candidates_.candidates.size(); ++id) {
      const Candidate& estimate = candidates_.candidates[id];
      if (const auto& real = baker_.sizes()[id])
        set_impostor(problem_, id, real->bytes, real->cost, model_, world_.camera);
      else
        set_impostor(problem_, id, correction.bytes * estimate.bytes, corrected(estimate.cost, correction), model_, world_.camera);
    }
  }

  const World& world_;
  const Subdivision& subdivision_;
  const CandidateSet& candidates_;
  const SizeModel& sizes_;
  const TimeModel& model_;
  double budget_ms_;
  const WorkBudget& budget_;
  Baker baker_;
  SelectionProblem problem_;
  // Costs of what is not baked are estimated with caution, so that few bakes leave a region short. Once all else is settled, regions that
  // nothing solves by such costs are tried without, for a few rounds.
  bool cautious_ = true;
  std::size_t bold_rounds_ = 0;
  SelectedImpostors result_;
};

}  // namespace

SelectedImpostors select_and_bake(const World& world, const Subdivision& subdivision, const CandidateSet& candidates,
                                  const SizeModel& sizes, const TimeModel& model, double budget_ms, const JobSpec& spec, StageClock& clock,
                                  const WorkBudget& budget) {
  auto rounds = clock.run("select", [&] { return Rounds(world, subdivision, candidates, sizes, model, budget_ms, budget); });
  for (int round = 0; round < spec.bake_rounds; ++round) {
    clock.run("select", [&] { rounds.select(spec); });
    if (clock.run("bake", [&] { return rounds.bake(); })) break;
  }
  return clock.run("select", [&] { return rounds.finish(spec.bound_iterations); });
}

}  // namespace standin
