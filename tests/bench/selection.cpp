// The selection alone, on one core, at the scale of the thesis' city: seconds, memory, evaluations, and the gap to the lower bound.
//
//     selection [FILE]        FILE: of selection_dump; without, a synthetic city (selection_city.h)
//
// Results: selection.md.
#include <sys/resource.h>

#include <cstdio>
#include <ctime>
#include <iostream>

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

void time_selection(const SelectionProblem& problem) {
  const Watch watch;
  const Selection selection = select_impostors(problem, {.bound_iterations = 0}, {}, {});
  const SelectionSummary& s = selection.summary;
  std::printf("| whole selection | %.2f s | %zu impostors, %.0f bytes after greedy, %.0f at last; %u stalled, %zu unmet | %.0f MB |\n",
              watch.seconds(), selection.chosen.size(), s.bytes_greedy, s.bytes, s.stalled, s.unmet.size(), peak_mb());
  for (const int steps : {0, 1, 10, 50, 100, 200}) {
    const Watch bound_watch;
    const double bound = memory_lower_bound(problem, s.bytes, {.bound_iterations = steps}, {});
    std::printf("| bound, %d steps | %.2f s | %.0f bytes, gap %.1f %% |\n", steps, bound_watch.seconds(), bound,
                100.0 * (s.bytes - bound) / s.bytes);
  }
}

void run(const SelectionProblem& problem) {
  describe(problem);
  time_greedy(problem);
  time_selection(problem);
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
