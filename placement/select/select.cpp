// The order of the selection's steps; each has a file of its own.
#include <algorithm>
#include <utility>

#include "placement/select/greedy.h"
#include "placement/select/lagrangian_bound.h"
#include "placement/select/reverse_delete.h"
#include "placement/select/selection_problem.h"
#include "placement/select/stall_repair.h"

namespace standin {
namespace {

class Selector {
 public:
  Selector(const SelectionProblem& problem, const SelectionConfig& config, const WorkBudget& budget)
      : problem_(problem),
        config_(config),
        budget_(budget),
        order_(problem.parent),
        columns_(problem, order_),
        finder_(problem, order_),
        cover_(problem, order_) {}

  Selection run(std::span<const std::uint32_t> initial) {
    for (const std::uint32_t candidate : initial) cover_.add(candidate);
    set_aside();
    pick();
    repair();
    result_.summary.bytes_greedy = bytes();
    reverse_delete(problem_, cover_, budget_);
    exchange(problem_, cover_, config_.exchange_rounds, budget_);
    assign();
    summarise();
    return std::move(result_);
  }

  double lower_bound(double known_bytes) {
    set_aside();
    return lagrangian_bound(problem_, order_, columns_, ignored_, known_bytes, config_.bound_iterations, budget_);
  }

 private:
  /// CPVs that need nothing, and those that nothing can solve: no bytes are spent on either. What S meets needs no look at all candidates.
  void set_aside() {
    ignored_.assign(problem_.cpv_count(), false);
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      budget_.check();
      if (!needs_gain(p)) {
        ignored_[p] = true;
      } else if (cover_.best(p).meets()) {
        continue;
      } else if (const Antichain best = best_of_all(p); !best.meets()) {
        ignored_[p] = true;
        result_.summary.unmet.push_back({p, best.violation});
      }
    }
  }

  void pick() {
    GreedyState state(problem_, columns_, ignored_);
    std::vector<std::uint32_t> unmet;
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      const Antichain now = cover_.best(p);
      state.represent(now.members);
      if (!now.meets()) unmet.push_back(p);
    }
    // Candidates that list no unmet CPV have no score.
    std::vector<bool> taken = columns_.candidates_without(unmet);
    for (const std::uint32_t member : cover_.members()) taken[member] = true;

    const GreedyPicks picks = config_.lazy ? pick_lazily(state, taken, config_.threads, budget_) : pick_plainly(state, taken, budget_);
    for (const std::uint32_t candidate : picks.order) cover_.add(candidate);
    result_.summary.picked_by_greedy = static_cast<std::uint32_t>(picks.order.size());
    result_.summary.evaluations = picks.evaluations;
  }

  void repair() {
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (ignored_[p]) continue;
      budget_.check();
      if (Antichain now = cover_.best(p); now.meets()) {
        cover_.assign(p, std::move(now.members));
      } else {
        ++result_.summary.stalled;
        repair_stall(problem_, cover_, p, best_of_all(p));
      }
    }
  }

  /// Everything that is paid for is used where it helps most, also at CPVs that stay over budget.
  void assign() {
    result_.assigned.resize(problem_.cpv_count());
    for (std::uint32_t p = 0; p < problem_.cpv_count(); ++p) {
      if (!needs_gain(p)) continue;
      const Antichain best = cover_.best(p);
      for (const Serving& serving : best.meets() || ignored_[p] ? best.members : cover_.antichain(p))
        result_.assigned[p].push_back(serving.candidate);
    }
    result_.chosen = cover_.members();
  }

  void summarise() {
    SelectionSummary& summary = result_.summary;
    summary.bytes = bytes();
    if (config_.bound_iterations > 0)
      summary.lower_bound_bytes = lagrangian_bound(problem_, order_, columns_, ignored_, summary.bytes, config_.bound_iterations, budget_);
    summary.stop = summary.unmet.empty() ? SelectionSummary::Stop::kAllMet : SelectionSummary::Stop::kSomeUnreachable;
    summary.message = summary.unmet.empty() ? "every region is within budget"
                                            : std::to_string(summary.unmet.size()) + " of " + std::to_string(problem_.cpv_count()) +
                                                  " regions stay over budget with any candidates";
  }

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
    for (const std::uint32_t candidate : cover_.members()) sum += problem_.bytes[candidate];
    return sum;
  }

  const SelectionProblem& problem_;
  const SelectionConfig config_;
  const WorkBudget& budget_;
  TreeOrder order_;
  Columns columns_;
  AntichainFinder finder_;
  std::vector<Serving> column_;  // scratch
  Cover cover_;
  std::vector<bool> ignored_;
  Selection result_;
};

}  // namespace

Selection select_impostors(const SelectionProblem& problem, const SelectionConfig& config, std::span<const std::uint32_t> initial,
                           const WorkBudget& budget) {
  validate(problem);
  for (const std::uint32_t candidate : initial)
    if (candidate >= problem.candidate_count())
      throw Failure(ErrorWord::kBadUsage, "initial candidate " + std::to_string(candidate) + " violates < " +
                                              std::to_string(problem.candidate_count()) + " (the number of candidates)");
  return Selector(problem, config, budget).run(initial);
}

double memory_lower_bound(const SelectionProblem& problem, double known_bytes, const SelectionConfig& config, const WorkBudget& budget) {
  validate(problem);
  return Selector(problem, config, budget).lower_bound(known_bytes);
}

}  // namespace standin
