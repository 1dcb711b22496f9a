#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "render/base/parallel.h"

namespace standin {
namespace {

TEST(ParallelFor, RunsEachTaskExactlyOnce) {
  for (const int threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> runs(1000);
    parallel_for(runs.size(), threads, WorkBudget{}, [&](std::size_t i) { ++runs[i]; });
    for (const auto& count : runs) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, TakesZeroTasks) {
  parallel_for(0, 4, WorkBudget{}, [](std::size_t) { FAIL(); });
}

TEST(ParallelFor, RunsInOrderOnOneThread) {
  std::vector<std::size_t> order;
  parallel_for(5, 1, WorkBudget{}, [&](std::size_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

// Task 0 is always started first, so its failure is the one of the lowest index whatever the schedule.
TEST(ParallelFor, RethrowsTheFailureOfTheLowestIndex) {
  for (const int threads : {1, 3}) {
    try {
      parallel_for(100, threads, WorkBudget{}, [](std::size_t i) { throw Failure(ErrorWord::kInternal, "task " + std::to_string(i)); });
      FAIL() << "nothing was thrown";
    } catch (const Failure& failure) {
      EXPECT_STREQ(failure.what(), "task 0");
    }
  }
}

TEST(ParallelFor, StopsOnRequest) {
  std::atomic<bool> stop{false};
  const WorkBudget budget(&stop);
  std::atomic<int> runs{0};
  try {
    parallel_for(1'000'000, 2, budget, [&](std::size_t) {
      ++runs;
      stop = true;
    });
    FAIL() << "ran to the end";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kCancelled);
  }
  EXPECT_LT(runs, 1'000'000);
}

TEST(WorkBudget, ReportsProgressAndNeverStopsByDefault) {
  double seen = 0.0;
  const WorkBudget budget(nullptr, [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "bake");
    seen = fraction;
  });
  budget.report("bake", 0.5);
  EXPECT_EQ(seen, 0.5);
  EXPECT_NO_THROW(WorkBudget{}.check());
  EXPECT_NO_THROW(WorkBudget{}.report("bake", 1.0));
}

}  // namespace
}  // namespace standin
