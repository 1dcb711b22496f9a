// Lazy equals plain, bit for bit, where rounding and ties would tell them apart.
#include "placement/select/greedy.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

GreedyPicks picks_of(const SelectionProblem& problem, bool lazy) {
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  GreedyState state(problem, columns, {});
  const std::vector<bool> none(problem.candidate_count(), false);
  return lazy ? pick_lazily(state, none, 1, {}) : pick_plainly(state, none, {});
}

using Instances = std::function<SelectionProblem(std::uint64_t seed)>;

void expect_same_picks(const char* name, const Instances& instances, std::uint64_t seeds) {
  std::uint64_t lazy_evaluations = 0;
  std::uint64_t plain_evaluations = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto problem = instances(seed);
    const auto lazy = picks_of(problem, true);
    const auto plain = picks_of(problem, false);
    ASSERT_EQ(lazy.order, plain.order) << name << ", seed " << seed;
    lazy_evaluations += lazy.evaluations;
    plain_evaluations += plain.evaluations;
  }
  EXPECT_LT(lazy_evaluations, plain_evaluations);
  std::printf("%s: %lu instances, %lu against %lu evaluations\n", name, static_cast<unsigned long>(seeds),
              static_cast<unsigned long>(lazy_evaluations), static_cast<unsigned long>(plain_evaluations));
}

void expect_same_picks(const char* name, const RandomShape& shape, std::uint64_t seeds) {
  expect_same_picks(
      name, [&](std::uint64_t seed) { return random_problem(seed, shape); }, seeds);
}

TEST(LazyGreedy, EqualsPlainWithRealGains) {
  expect_same_picks("real", {.nodes = 30, .candidates = 60, .cpvs = 12, .integers = false, .demand = 40.0}, 300);
}
TEST(LazyGreedy, EqualsPlainWithManyTies) {
  expect_same_picks("ties", {.nodes = 30, .candidates = 60, .cpvs = 12, .ties = true}, 300);
}
TEST(LazyGreedy, EqualsPlainInThreeStages) {
  expect_same_picks("stages", {.nodes = 20, .candidates = 40, .cpvs = 8, .stages = 3, .integers = false, .demand = 40.0}, 200);
}
TEST(LazyGreedy, EqualsPlainWithNegativeGains) {
  expect_same_picks("negative", {.nodes = 20, .candidates = 40, .cpvs = 8, .stages = 2, .negative = 0.4, .demand = 40.0}, 200);
}

TEST(LazyGreedy, EqualsPlainWithWorthsAndCosts) {
  for (const std::uint32_t stages : {1U, 2U})
    expect_same_picks(
        "factored", [=](std::uint64_t seed) { return random_factored_problem(seed, {.stages = stages}); }, 200);
}

void expect_no_score_rises(const Instances& instances) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto problem = instances(seed);
    const TreeOrder order(problem.parent);
    const Columns columns(problem, order);
    GreedyState state(problem, columns, {});
    std::vector<double> before(problem.candidate_count());
    for (std::uint32_t c = 0; c < before.size(); ++c) before[c] = state.score(c);
    for (const std::uint32_t pick : picks_of(problem, false).order) {
      state.take(pick);
      for (std::uint32_t c = 0; c < before.size(); ++c) {
        const double now = state.score(c);
        ASSERT_LE(now, before[c]) << "seed " << seed << ", candidate " << c;
        before[c] = now;
      }
    }
  }
}

TEST(LazyGreedy, NoScoreEverRises) {
  expect_no_score_rises([](std::uint64_t seed) {
    return random_problem(seed, {.nodes = 30, .candidates = 50, .cpvs = 10, .integers = false, .demand = 40.0});
  });
  for (const std::uint32_t stages : {1U, 2U})
    expect_no_score_rises([=](std::uint64_t seed) { return random_factored_problem(seed, {.stages = stages}); });
}

// One cell, one region: cluster 0 with parts 1 and 2 is worth 9 = 4 + 5. Candidates 0 and 1 stand for cluster 1, 2 for the whole.
SelectionProblem shared_blocks(double deficit) {
  SelectionProblem problem;
  problem.parent = {-1, 0, 0};
  problem.deficit = {deficit};
  problem.form = {0};
  problem.block_offset = {0, 1, 2};
  problem.cpv = {0, 0};
  problem.worth = {4.0, 9.0};
  problem.node = {1, 1, 0};
  problem.bytes = {1.0, 1.0, 2.0};
  problem.cost = {0.3, 0.3, 0.7};
  problem.run_offset = {0, 1, 2, 3};
  problem.runs = {{0, 1}, {0, 1}, {1, 2}};
  return problem;
}

TEST(GreedyState, EquallyDearImpostorOfTheSameClusterGainsExactlyNothing) {
  const auto problem = shared_blocks(100.0);
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  GreedyState state(problem, columns, {});
  EXPECT_DOUBLE_EQ(state.score(1), 3.7);
  state.take(0);
  EXPECT_EQ(state.score(1), 0.0);
  EXPECT_DOUBLE_EQ(state.score(2), (9.0 - 0.7 - 3.7) / 2.0);
}

TEST(GreedyState, WhatIsRepresentedAlreadyIsNotGainedAgain) {
  const auto problem = shared_blocks(5.0);
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  GreedyState state(problem, columns, {});
  const Serving part{0, 0};
  state.represent({&part, 1});
  EXPECT_FALSE(state.all_met());
  EXPECT_DOUBLE_EQ(state.score(2), (5.0 - 3.7) / 2.0);  // all that is missing
  state.take(2);
  EXPECT_TRUE(state.all_met());
  EXPECT_EQ(state.score(1), 0.0);  // its ancestor is in use
}

TEST(GreedyState, AMemberThatCostsMayLeaveARegionUnmetAgain) {
  // Two stages; the second member gains in one and loses in the other.
  const auto problem =
      make_problem({-1, -1}, {{0, 1.0, {{0, {2.0, 2.0}}}}, {1, 1.0, {{0, {3.0, -1.0}}}}, {0, 1.0, {{0, {4.0, 4.0}}}}}, {2.0, 2.0}, 2);
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  GreedyState state(problem, columns, {});
  const std::vector<Serving> antichain = {{0, 0}, {1, 1}};
  state.represent(antichain);
  EXPECT_FALSE(state.all_met());
  state.take(2);
  EXPECT_TRUE(state.all_met());
}

TEST(GreedyState, LargerClusterReplacesItsPartsAndGainsTheDifference) {
  // Parent 0 with children 1 and 2. The children's impostors gain 2 and 3; the parent's gains 7, so 2 more than both.
  const auto problem = make_problem({-1, 0, 0}, {{1, 1.0, {{0, {2.0}}}}, {2, 1.0, {{0, {3.0}}}}, {0, 4.0, {{0, {7.0}}}}}, {100.0});
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  GreedyState state(problem, columns, {});
  EXPECT_DOUBLE_EQ(state.score(2), 7.0 / 4.0);
  state.take(0);
  EXPECT_DOUBLE_EQ(state.score(2), 5.0 / 4.0);
  state.take(1);
  EXPECT_DOUBLE_EQ(state.score(2), 2.0 / 4.0);
  state.take(2);
  EXPECT_EQ(state.score(0), 0.0);  // its ancestor is in use
}

TEST(TreeOrder, RangesAreSubtrees) {
  const TreeOrder order(std::vector<std::int32_t>{-1, 0, 0, 1, 1, 2, -1});
  const auto inside = [&](std::uint32_t a, std::uint32_t b) { return order.first(b) <= order.first(a) && order.last(a) <= order.last(b); };
  EXPECT_TRUE(inside(3, 1));
  EXPECT_TRUE(inside(4, 0));
  EXPECT_TRUE(inside(5, 2));
  EXPECT_FALSE(inside(5, 1));
  EXPECT_FALSE(inside(6, 0));
  EXPECT_FALSE(inside(0, 6));
  EXPECT_EQ(order.first(3), order.last(3));
}

}  // namespace
}  // namespace standin::test
