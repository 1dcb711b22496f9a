// Small instances solved by hand.
#include <gtest/gtest.h>

#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

using Ids = std::vector<std::uint32_t>;

Selection select(const SelectionProblem& problem, const SelectionConfig& config = {}, const Ids& initial = {}) {
  return select_impostors(problem, config, initial, {});
}

TEST(Select, NothingToDo) {
  const auto selection = select(make_problem({-1}, {{0, 1.0, {{0, {1.0}}}}}, {0.0, -3.0}));
  EXPECT_TRUE(selection.chosen.empty());
  EXPECT_EQ(selection.assigned, (std::vector<Ids>{{}, {}}));
  EXPECT_EQ(selection.summary.bytes, 0.0);
  EXPECT_EQ(selection.summary.lower_bound_bytes, 0.0);
  EXPECT_TRUE(select(make_problem({}, {}, {})).chosen.empty());
}

TEST(Select, NoCandidatesMeansEveryCpvIsReported) {
  const auto selection = select(make_problem({-1}, {}, {2.0, 5.0}));
  ASSERT_EQ(selection.summary.unmet.size(), 2U);
  EXPECT_EQ(selection.summary.unmet[1].cpv, 1U);
  EXPECT_EQ(selection.summary.unmet[1].residual, 5.0);
  EXPECT_EQ(selection.summary.stop, SelectionSummary::Stop::kSomeUnreachable);
}

TEST(Select, AncestorLockOutIsRepaired) {
  // math.md 5.2: the greedy takes the parent (score 1) and is stuck at residual 2; only both children do.
  const auto problem = make_problem({-1, 0, 0}, {{0, 10.0, {{0, {10.0}}}}, {1, 7.0, {{0, {6.0}}}}, {2, 7.0, {{0, {6.0}}}}}, {12.0});
  const auto selection = select(problem);
  EXPECT_EQ(selection.chosen, (Ids{1, 2}));
  EXPECT_EQ(selection.assigned[0], (Ids{1, 2}));
  EXPECT_EQ(selection.summary.stalled, 1U);
  EXPECT_EQ(selection.summary.bytes, 14.0);
  EXPECT_EQ(selection.summary.picked_by_greedy, 1U);
}

TEST(Select, StagesAreMetTogether) {
  // math.md 5.2 (b): the maximum over stages would score both candidates 0.
  const auto problem = make_problem({-1, 0, 0}, {{1, 3.0, {{0, {5.0, 0.0}}}}, {2, 4.0, {{0, {0.0, 5.0}}}}}, {5.0, 5.0}, 2);
  EXPECT_EQ(select(problem).chosen, (Ids{0, 1}));
}

TEST(Select, MixedSignsAreSolvedByTheRepair) {
  // The only solution needs candidate 0, which costs 1 in stage 1: the safe greedy refuses it.
  const auto problem = make_problem({-1, 0, 0}, {{1, 1.0, {{0, {6.0, -1.0}}}}, {2, 1.0, {{0, {0.0, 4.0}}}}}, {5.0, 3.0}, 2);
  const auto selection = select(problem);
  EXPECT_EQ(selection.chosen, (Ids{0, 1}));
  EXPECT_TRUE(selection.summary.unmet.empty());
  EXPECT_EQ(selection.summary.stalled, 1U);
}

TEST(Select, ReverseDeleteDropsTheEarlyPick) {
  // Candidate 0 has the best score (8 over 3 CPVs), but 1 and 2 are needed anyway and suffice.
  const auto problem =
      make_problem({-1, 0, 0, 0}, {{1, 2.0, {{0, {4.0}}, {1, {4.0}}}}, {2, 3.0, {{0, {5.0}}}}, {3, 3.0, {{1, {5.0}}}}}, {5.0, 5.0});
  const auto selection = select(problem);
  EXPECT_EQ(selection.chosen, (Ids{1, 2}));
  EXPECT_EQ(selection.summary.picked_by_greedy, 3U);
  EXPECT_EQ(selection.summary.bytes_greedy, 8.0);
  EXPECT_EQ(selection.summary.bytes, 6.0);
}

TEST(Select, ExchangeFindsTheSharedImpostor) {
  // The greedy prefers 0 and 1 (5/4 a byte) to the shared 2 (10/9 a byte)... which is dearer: 8 against 9. Made cheaper by a third CPV.
  const auto problem = make_problem(
      {-1, 0, 0, 0},
      {{1, 4.0, {{0, {5.0}}}}, {2, 4.0, {{1, {5.0}}}}, {3, 7.9, {{0, {4.9}}, {1, {4.9}}}}, {1, 0.1, {{0, {5.0}}}}, {2, 7.8, {{1, {5.0}}}}},
      {5.0, 5.0});
  const auto plain = select(problem);
  const auto exchanged = select(problem, {.exchange_rounds = 3});
  EXPECT_LE(exchanged.summary.bytes, plain.summary.bytes);
  EXPECT_EQ(exchanged.chosen, (Ids{1, 3}));
}

TEST(Select, NothingIsSpentOnTheUnreachable) {
  // CPV 1 needs 100 and can get 1 at a cost of 50 bytes; what is bought for CPV 0 helps it by 0.5.
  const auto problem = make_problem({-1, 0, 0}, {{1, 2.0, {{0, {3.0}}, {1, {0.5}}}}, {2, 50.0, {{1, {1.0}}}}}, {3.0, 100.0});
  const auto selection = select(problem);
  EXPECT_EQ(selection.chosen, (Ids{0}));
  EXPECT_EQ(selection.assigned, (std::vector<Ids>{{0}, {0}}));
  ASSERT_EQ(selection.summary.unmet.size(), 1U);
  EXPECT_EQ(selection.summary.unmet[0].cpv, 1U);
  EXPECT_DOUBLE_EQ(selection.summary.unmet[0].residual, 98.5);
  EXPECT_LE(selection.summary.lower_bound_bytes, 2.0);
  EXPECT_GE(selection.summary.lower_bound_bytes, 1.9);
}

TEST(Select, GoesOnFromWhatIsBaked) {
  // Baked: candidate 0 gains 4 of 6. The cheapest addition is 2, though 1 would do alone.
  const auto problem = make_problem({-1, 0, 0, 0}, {{1, 5.0, {{0, {4.0}}}}, {2, 6.0, {{0, {6.0}}}}, {3, 1.0, {{0, {2.0}}}}}, {6.0});
  EXPECT_EQ(select(problem, {}, {0}).chosen, (Ids{0, 2}));
  EXPECT_EQ(select(problem, {}, {0}).summary.picked_by_greedy, 1U);
}

TEST(Select, BakedButUselessIsDropped) {
  const auto problem = make_problem({-1, 0, 0}, {{1, 5.0, {{0, {4.0}}}}, {2, 1.0, {{0, {6.0}}}}}, {6.0});
  EXPECT_EQ(select(problem, {}, {0}).chosen, (Ids{1}));
}

TEST(Select, TiesGoToTheLowerId) {
  const auto problem = make_problem({-1, 0, 0}, {{1, 2.0, {{0, {4.0}}}}, {2, 2.0, {{0, {4.0}}}}}, {4.0});
  EXPECT_EQ(select(problem).chosen, (Ids{0}));
}

TEST(Select, BrokenProblemsAreNamed) {
  const auto word_of = [](const SelectionProblem& problem) {
    try {
      (void)select(problem);
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kInternal;
  };
  const auto good = make_problem({-1, 0}, {{1, 2.0, {{0, {4.0}}, {1, {1.0}}}}}, {4.0, 1.0});
  auto problem = good;
  problem.bytes[0] = 0.0;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.cpv[1] = 0;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.parent[1] = 1;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.worth[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.block_offset[1] = 7;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.runs[0].end = 2;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = good;
  problem.form[1] = 1;
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  problem = make_problem({-1, 0, 0}, {{1, 2.0, {{0, {4.0}}}}, {2, 2.0, {{0, {4.0}}}}}, {4.0});
  problem.runs[1] = {0, 2};  // of another node
  EXPECT_EQ(word_of(problem), ErrorWord::kBadUsage);
  EXPECT_THROW((void)select(good, {}, {1}), Failure);
}

TEST(Select, StopsOnRequest) {
  const std::atomic<bool> stop{true};
  const auto problem = make_problem({-1, 0}, {{1, 2.0, {{0, {4.0}}}}}, {4.0});
  EXPECT_THROW((void)select_impostors(problem, {}, {}, WorkBudget(&stop)), Failure);
}

}  // namespace
}  // namespace standin::test
