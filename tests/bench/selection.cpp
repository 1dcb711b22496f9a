// The selection alone, on one core, at the scale of the thesis' city: seconds, memory, evaluations, and the gap to the lower bound.
//
//     selection [FILE]        FILE: of selection_dump; without, a synthetic city (selection_city.h)
//
// Results: selection.md.
#include <sys/resource.h>

#include <cstdio>
#include <ctime>
#include <iostream>

#include "placement/select/fewest_shown.h"
#include "placement/select/greedy.h"
#include "placement/select/selection_problem.h"
#include "tests/bench/selection_city.h"
#include "tests/bench/selection_file.h"

namespace standin {
namespace {

/// Processor seconds of this process, which runs on one thread: other programs' share of the core is not counted.
class Watch {
 public:
  [[nodiscard]] double seconds() const { return static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void describe(const SelectionProblem& problem) {
  std::uint64_t gains = 0;
  for (std::uint32_t c = 0; c < problem.candidate_count(); ++c)
    for (const BlockRun& run : problem.runs_of(c)) gains += problem.block_offset[run.end] - problem.block_offset[run.begin];
  std::printf("%u CPVs, %u candidates, %zu nodes, %u blocks, %zu entries, %zu runs, %llu gains; %.0f MB resident\n", problem.cpv_count(),
              problem.candidate_count(), problem.parent.size(), problem.block_count(), problem.cpv.size(), problem.runs.size(),
              static_cast<unsigned long long>(gains), peak_mb());
}

void time_greedy(const SelectionProblem& problem) {
  const Watch all;
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  std::printf("| columns | %.2f s | %.0f MB |\n", all.seconds(), peak_mb());
  const Watch watch;
  GreedyState state(problem, columns, {});
  const auto picks = pick_lazily(state, std::vector<bool>(problem.candidate_count(), false), 1, {});
  const double plain = static_cast<double>(problem.candidate_count()) * static_cast<double>(picks.order.size() + 1);
  std::printf("| greedy | %.2f s | %zu picks, %llu evaluations; a plain greedy %.3g | %.0f MB |\n", watch.seconds(), picks.order.size(),
              static_cast<unsigned long long>(picks.evaluations), plain, peak_mb());
}

Selection time_selection(const SelectionProblem& problem, const char* name, const SelectionConfig& config) {
  const Watch watch;
  Selection selection = select_impostors(problem, config, {}, {});
  const SelectionSummary& s = selection.summary;
  std::printf("| %s | %.2f s | %zu impostors, %.0f bytes after greedy%s, %.0f at last; %u stalled, %zu unmet; %.3g gains | %.0f MB |\n",
              name, watch.seconds(), selection.chosen.size(), s.bytes_greedy, s.guided ? " (the second)" : "", s.bytes, s.stalled,
              s.unmet.size(), static_cast<double>(s.gains), peak_mb());
  return selection;
}

void time_bound(const SelectionProblem& problem, const Selection& selection, double limit_s) {
  const Watch watch;
  const double bound = memory_lower_bound(problem, selection, {.out_of_time = [&] { return watch.seconds() >= limit_s; }}, {});
  std::printf("| bound, at most %.0f s | %.2f s | %.0f bytes; gap %.1f %% | %.0f MB |\n", limit_s, watch.seconds(), bound,
              100.0 * (1.0 - bound / selection.summary.bytes), peak_mb());
}

void count_shown(const SelectionProblem& problem, Selection& selection) {
  const Watch watch;
  const ShownImpostors shown = show_fewest(problem, selection, {});
  std::printf("| fewest shown | %.2f s | %llu impostors in all regions together, %llu before | %.0f MB |\n", watch.seconds(),
              static_cast<unsigned long long>(shown.after), static_cast<unsigned long long>(shown.before), peak_mb());
}

void run(const SelectionProblem& problem) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  describe(problem);
  time_greedy(problem);
  (void)time_selection(problem, "greedy, repair, reverse-delete", {.bound_iterations = 0});
  (void)time_selection(problem, "with a second greedy", {.guided_sweeps = 30, .bound_iterations = 0});
  Selection best = time_selection(problem, "and 1,000 trials of ruin and recreate",
                                  {.guided_sweeps = 30, .recreate_trials = 1000, .bound_iterations = 0});
  count_shown(problem, best);
  for (const double limit_s : {1.0, 10.0, 30.0}) time_bound(problem, best, limit_s);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    standin::run(argc > 1 ? standin::read_selection_problem(argv[1]) : standin::SelectionCity({}).take());
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
