#include "server/sweep/budgets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/sweep/points.h"

namespace standin {
namespace {

TEST(SweepBudgets, LieStrictlyBetweenReachableAndNeedless) {
  for (const auto& [reachable, worst] : std::vector<std::pair<double, double>>{
           {10.0, 20.0}, {41.7536257412964, 50.80148675459365}, {0.0012, 0.0013}, {1e3, 1e9}, {7.0, 7.00001}}) {
    const SweepBudgets chosen = choose_budgets(reachable, worst);
    EXPECT_EQ(chosen.budgets_ms.size(), static_cast<std::size_t>(kChosenBudgets));
    EXPECT_EQ(chosen.budgets_ms, ascending(chosen.budgets_ms));
    EXPECT_GT(chosen.budgets_ms.front(), reachable);
    EXPECT_LT(chosen.budgets_ms.back(), worst);
  }
  EXPECT_EQ(choose_budgets(10.0, 20.0).budgets_ms.front(), 10.5);
  EXPECT_EQ(milliseconds_text(choose_budgets(41.7536257412964, 50.80148675459365).budgets_ms.front()), "42.21 ms");
  EXPECT_THAT(choose_budgets(10.0, 20.0).chosen, testing::HasSubstr("10 budgets"));
}

TEST(SweepBudgets, WhereImpostorsDoNotHelpNoneIsChosen) {
  for (const double reachable : {20.0, 21.0}) {
    const Failure failure = test::failure_of([&] { static_cast<void>(choose_budgets(reachable, 20.0)); });
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
    EXPECT_THAT(failure.what(), testing::HasSubstr("--budgets-ms"));
  }
}

TEST(SweepBudgets, AreSortedEachOnce) {
  EXPECT_THAT(ascending({3.0, 1.0, 3.0, 2.0}), testing::ElementsAre(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace standin
