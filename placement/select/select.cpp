// The order of the selection's steps; each has a file of its own.
#include <algorithm>
#include <memory>
#include <utility>

#include "placement/select/greedy.h"
#include "placement/select/lagrangian_bound.h"
#include "placement/select/reverse_delete.h"
#include "placement/select/ruin_and_recreate.h"
#include "placement/select/selection_problem.h"
#include "placement/select/stall_repair.h"

namespace standin {
namespace {

// Prices of the second greedy: bytes that no region pays for, and this share of all bytes.
constexpr double kShareOfBytes = 0.25;

class Selector {
 public:
  Selector(const SelectionProblem& problem, const SelectionConfig& config, const WorkBudget& budget)
      : problem_(problem),
        config_(config),
        budget_(budget),
        order_(problem.parent),
        columns_(problem, order_),
        finder_(problem, order_),
        work_(config.most_gains, config.out_of_time, config.gains_before) {}

  Selection run(std::span<const std::uint32_t> initial) {
    cover_ = std::make_unique<Cover>(problem_, order_);
    for (const std::uint32_t candidate : initial) cover_->add(candidate);
    set_aside();
    if (pick({})) {
      repair();
      result_.summary.bytes_greedy = bytes();
      tell("greedy");
      if (config_.reverse_delete) step("reverse-delete", [&] { return reverse_delete(problem_, *cover_, budget_, work_); });
      if (initial.empty()) pick_at_prices();
      if (config_.exchange_rounds > 0)
        step("exchange", [&] { return exchange(problem_, *cover_, config_.exchange_rounds, budget_, work_); });
      if (initial.empty() && config_.recreate_trials > 0) step("ruin and recreate", [&] { return recreate(); });
    } else {
      give_up();
    }
    assign();
    summarise();
    return std::move(result_);
  }

  double lower_bound(const Selection& known) {
    cover_ = std::make_unique<Cover>(problem_, order_);
    for (const std::uint32_t candidate : known.chosen) cover_->add(candidate);
    set_aside();
    return bound();
  }

 private:
  /// CPVs that need nothing, and those that nothing can solve: no bytes are spent on either. What S meets needs no look at all candidates.
  void set_aside() {
    ignored_.assign(problem_.cpv_count(), false);
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      budget_.check();
      if (!needs_gain(p)) {
        ignored_[p] = true;
      } else if (cover_->best(p).meets()) {
        continue;
      } else if (const Antichain best = best_of_all(p); !best.meets()) {
        ignored_[p] = true;
        result_.summary.unmet.push_back({p, best.violation});
      }
    }
  }

  /// `price`: of the greedy, in place of the bytes. False when the work limit cut it short.
  bool pick(std::vector<double> price) {
    GreedyState state(problem_, columns_, ignored_, std::move(price));
    std::vector<std::uint32_t> unmet;
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      const Antichain now = cover_->best(p);
      state.represent(now.members);
      if (!now.meets()) unmet.push_back(p);
    }
    // Candidates that list no unmet CPV have no score.
    std::vector<bool> taken = columns_.candidates_without(unmet);
    for (const std::uint32_t member : cover_->members()) taken[member] = true;

    const GreedyPicks picks =
        config_.lazy ? pick_lazily(state, taken, config_.threads, budget_, work_) : pick_plainly(state, taken, budget_);
    for (const std::uint32_t candidate : picks.order) cover_->add(candidate);
    picked_ = static_cast<std::uint32_t>(picks.order.size());
    result_.summary.evaluations += picks.evaluations;
    return !picks.cut_short;
  }

  void repair() {
    result_.summary.picked_by_greedy = picked_;
    result_.summary.stalled = 0;
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      budget_.check();
      if (Antichain now = cover_->best(p); now.meets()) {
        cover_->assign(p, std::move(now.members));
      } else {
        ++result_.summary.stalled;
        repair_stall(problem_, *cover_, p, best_of_all(p));
      }
    }
  }

  /// A second greedy at the lower bound's prices, which know what is wanted by many and what nobody would pay for; kept if it ends cheaper.
  void pick_at_prices() {
    if (config_.guided_sweeps == 0 || cover_->members().empty()) return;
    step("second greedy", [&] {
      if (work_.exhausted()) return false;
      BytesSplit split(problem_, order_, columns_);
      const double first_bytes = bytes();
      const bool priced = improve_by(tight_constraints(), split, first_bytes, config_.guided_sweeps, budget_, work_);
      result_.summary.priced_bound_bytes = split.certified(budget_);
      if (!priced) return false;
      std::vector<double> price(problem_.candidate_count());
      for (std::uint32_t c = 0; c < price.size(); ++c)
        price[c] = kShareOfBytes * problem_.bytes[c] + std::max(0.0, split.unclaimed_bytes(c));

      const SelectionSummary first_summary = result_.summary;
      auto first = std::exchange(cover_, std::make_unique<Cover>(problem_, order_));
      const bool picked = pick(std::move(price));
      const std::uint64_t evaluations = result_.summary.evaluations;
      bool finished = picked;
      if (picked) {
        repair();
        result_.summary.bytes_greedy = bytes();
        if (config_.reverse_delete) finished = reverse_delete(problem_, *cover_, budget_, work_);
      }
      result_.summary.guided = picked && bytes() < first_bytes;
      if (!result_.summary.guided) {
        cover_ = std::move(first);
        result_.summary = first_summary;
        result_.summary.evaluations = evaluations;
      }
      return finished;
    });
  }

  bool recreate() {
    result_.summary.trials = ruin_and_recreate(problem_, order_, columns_, *cover_, config_.recreate_trials, budget_, work_);
    return result_.summary.trials == config_.recreate_trials && reverse_delete(problem_, *cover_, budget_, work_);
  }

  /// `improvement`: returns whether it was finished.
  template <class Improvement>
  void step(const char* name, Improvement&& improvement) {
    const double before = bytes();
    if (!improvement()) result_.summary.cut_short.push_back({name, before, bytes()});
    tell(name);
  }

  void tell(const char* name) const {
    if (config_.on_step) config_.on_step({name, work_.gains() - config_.gains_before, bytes()});
  }

  /// The greedy was cut short: what its picks meet is met, the rest is not.
  void give_up() {
    result_.summary.picked_by_greedy = picked_;
    result_.summary.bytes_greedy = bytes();
    result_.summary.cut_short.push_back({"greedy", 0.0, bytes()});
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      Antichain now = cover_->best(p);
      if (now.meets()) {
        cover_->assign(p, std::move(now.members));
      } else {
        result_.summary.unmet.push_back({p, now.violation});
        ignored_[p] = true;
      }
    }
    std::ranges::sort(result_.summary.unmet, {}, &Shortfall::cpv);
  }

  /// Everything that is paid for is used where it helps most, also at CPVs that stay over budget.
  void assign() {
    result_.assigned.resize(problem_.cpv_count());
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (!needs_gain(p)) continue;
      const Antichain best = cover_->best(p);
      for (const Serving& serving : best.meets() || ignored_[p] ? best.members : cover_->antichain(p))
        result_.assigned[p].push_back(serving.candidate);
    }
    result_.chosen = cover_->members();
  }

  void summarise() {
    SelectionSummary& summary = result_.summary;
    summary.bytes = bytes();
    const bool greedy_cut_short = !summary.cut_short.empty() && summary.cut_short.front().step == "greedy";
    if (config_.bound_iterations > 0 && !greedy_cut_short) summary.lower_bound_bytes = bound();
    summary.gains = work_.gains() - config_.gains_before;
    using Stop = SelectionSummary::Stop;
    summary.stop = greedy_cut_short ? Stop::kGreedyCutShort : summary.unmet.empty() ? Stop::kAllMet : Stop::kSomeUnreachable;
    summary.message = met_message() + limit_message();
  }

  double bound() {
    BytesSplit split(problem_, order_, columns_);
    if (!improve_by(tight_constraints(), split, bytes(), config_.bound_iterations, budget_, work_))
      result_.summary.cut_short.push_back({"lower bound", bytes(), bytes()});
    return split.certified(budget_);
  }

  [[nodiscard]] TightConstraints tight_constraints() {
    TightConstraints tight(problem_);
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      budget_.check();
      tight.see(p, cover_->best(p).members);
    }
    tight.sort();
    return tight;
  }

  [[nodiscard]] std::string met_message() const {
    const auto& unmet = result_.summary.unmet;
    if (unmet.empty()) return "every region is within budget";
    const std::string count = std::to_string(unmet.size()) + " of " + std::to_string(problem_.cpv_count());
    if (result_.summary.stop == SelectionSummary::Stop::kGreedyCutShort)
      return count + " regions are over budget with what was chosen so far";
    return count + " regions stay over budget with any candidates";
  }

  [[nodiscard]] std::string limit_message() const {
    const SelectionSummary& summary = result_.summary;
    if (summary.cut_short.empty()) return "";
    std::string message = work_.reached() == SelectionWork::Limit::kDeadline
                              ? "; the deadline (another run may end elsewhere) cut short: "
                              : "; the work limit of " + std::to_string(config_.most_gains) + " gains cut short: ";
    for (const CutShort& cut : summary.cut_short) {
      if (&cut != &summary.cut_short.front()) message += ", ";
      message += cut.step + " (" + whole(cut.bytes_before) + " bytes before, " + whole(cut.bytes_after) + " after)";
    }
    if (summary.lower_bound_bytes > 0.0) message += "; lower bound so far " + whole(summary.lower_bound_bytes) + " bytes";
    return message;
  }

  static std::string whole(double bytes) { return std::to_string(static_cast<std::uint64_t>(bytes)); }

  /// The best antichain over all candidates.
  [[nodiscard]] Antichain best_of_all(std::uint32_t cpv) {
    if (problem_.stages == 1)
      columns_.read_best(cpv, column_);
    else
      columns_.read(cpv, column_);
    return finder_.best(column_, cpv);
  }

  [[nodiscard]] bool needs_gain(std::uint32_t cpv) const {
    const auto first = problem_.deficit.begin() + static_cast<std::ptrdiff_t>(cpv) * problem_.stages;
    return std::any_of(first, first + problem_.stages, [](double deficit) { return deficit > 0.0; });
  }

  [[nodiscard]] double bytes() const {
    double sum = 0.0;
    for (const std::uint32_t candidate : cover_->members()) sum += problem_.bytes[candidate];
    return sum;
  }

  const SelectionProblem& problem_;
  const SelectionConfig config_;
  const WorkBudget& budget_;
  TreeOrder order_;
  Columns columns_;
  AntichainFinder finder_;
  SelectionWork work_;
  std::vector<Serving> column_;  // scratch
  std::unique_ptr<Cover> cover_;
  std::vector<bool> ignored_;
  std::uint32_t picked_ = 0;  // by the latest greedy
  Selection result_;
};

void require_candidates(const SelectionProblem& problem, std::span<const std::uint32_t> candidates, const char* what) {
  for (const std::uint32_t candidate : candidates)
    if (candidate >= problem.candidate_count())
      throw Failure(ErrorWord::kBadUsage, std::string(what) + " candidate " + std::to_string(candidate) + " violates < " +
                                              std::to_string(problem.candidate_count()) + " (the number of candidates)");
}

}  // namespace

Selection select_impostors(const SelectionProblem& problem, const SelectionConfig& config, std::span<const std::uint32_t> initial,
                           const WorkBudget& budget) {
  validate(problem);
  require_candidates(problem, initial, "initial");
  return Selector(problem, config, budget).run(initial);
}

double memory_lower_bound(const SelectionProblem& problem, const Selection& known, const SelectionConfig& config,
                          const WorkBudget& budget) {
  validate(problem);
  require_candidates(problem, known.chosen, "known");
  return Selector(problem, config, budget).lower_bound(known);
}

}  // namespace standin
