// The lower bound: never above the optimum, exact where the relaxation is, better with more steps.
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

#include "placement/select/lagrangian_bound.h"
#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

/// By the given constraints.
double bound_by(const SelectionProblem& problem, std::span<const std::uint32_t> constraints, double upper_bytes, int iterations) {
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  BytesSplit split(problem, order, columns);
  split.add(constraints, UINT64_MAX, {});
  SelectionWork work;
  (void)improve(split, upper_bytes, iterations, {}, work);
  return split.certified({});
}

/// All constraints but those of CPVs with `ignored[p]`.
std::vector<std::uint32_t> constraints_of(const SelectionProblem& problem, const std::vector<bool>& ignored) {
  std::vector<std::uint32_t> constraints;
  for (std::uint32_t q = 0; q < problem.deficit.size(); ++q)
    if (ignored.empty() || !ignored[q / problem.stages]) constraints.push_back(q);
  return constraints;
}

double bound_of(const SelectionProblem& problem, double upper_bytes, int iterations) {
  return bound_by(problem, constraints_of(problem, {}), upper_bytes, iterations);
}

TEST(LagrangianBound, NeverAboveTheOptimum) {
  double sum_ratio = 0.0;
  int count = 0;
  for (const std::uint32_t stages : {1U, 3U}) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto problem = random_problem(seed, {.cpvs = 3, .stages = stages, .integers = false});
      const auto exact = BruteForce(problem).optimum();
      if (!exact) continue;
      const double bound = bound_of(problem, exact->bytes, 100);
      ASSERT_LE(bound, exact->bytes) << "seed " << seed << ", stages " << stages;
      sum_ratio += bound / exact->bytes;
      ++count;
    }
  }
  EXPECT_GT(count, 50);
  EXPECT_GT(sum_ratio / count, 0.8);  // the sum over all candidates came to 0.71-0.85 on one stage, 0.71 on three
  std::printf("%d instances, mean bound / optimum %.3f\n", count, sum_ratio / count);
}

TEST(LagrangianBound, HoldsWhereOnlySomeConstraintsAreLookedAt) {
  int lower = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto problem = random_problem(seed, {.cpvs = 4, .stages = 1, .integers = false});
    const auto exact = BruteForce(problem).optimum();
    if (!exact) continue;
    const double some = bound_by(problem, std::vector<std::uint32_t>{1, 3}, exact->bytes, 100);
    ASSERT_LE(some, exact->bytes) << "seed " << seed;
    lower += some < 0.99 * bound_of(problem, exact->bytes, 100) ? 1 : 0;
  }
  EXPECT_GT(lower, 20);
}

// What was found before constraints were added still holds with them: the next sweep begins there, and all ends below the optimum.
TEST(LagrangianBound, GoesOnFromFewerConstraints) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto problem = random_problem(seed, {.cpvs = 4, .stages = seed % 2 == 0 ? 1U : 3U, .integers = false});
    const auto exact = BruteForce(problem).optimum();
    if (!exact) continue;
    const TreeOrder order(problem.parent);
    const Columns columns(problem, order);
    const std::vector<std::uint32_t> all = constraints_of(problem, {});
    BytesSplit split(problem, order, columns);
    for (const std::size_t last : {std::size_t{1}, all.size() / 2, all.size()}) {
      const double before = split.certified({});
      split.add(std::span(all).first(last), UINT64_MAX, {});
      ASSERT_GE(split.certified({}), before * (1.0 - 1e-9)) << "seed " << seed;
      ASSERT_GE(split.sweep({}), split.best_value() * (1.0 - 1e-9)) << "seed " << seed;
      SelectionWork work;
      (void)improve(split, exact->bytes, 30, {}, work);
      ASSERT_LE(split.certified({}), exact->bytes) << "seed " << seed << ", " << last << " constraints";
    }
    ++count;
  }
  EXPECT_GT(count, 30);
}

TEST(LagrangianBound, AddsConstraintsOnceAndAsManyAsAreAffordable) {
  const auto problem = random_problem(5, {.nodes = 60, .candidates = 200, .cpvs = 40, .integers = false, .demand = 60.0});
  const TreeOrder order(problem.parent);
  const Columns columns(problem, order);
  const std::vector<std::uint32_t> all = constraints_of(problem, {});
  BytesSplit split(problem, order, columns);
  split.add(std::span(all).first(20), UINT64_MAX, {});
  split.add(all, UINT64_MAX, {});
  BytesSplit at_once(problem, order, columns);
  at_once.add(all, UINT64_MAX, {});
  EXPECT_EQ(split.gains(), at_once.gains());
  BytesSplit some(problem, order, columns);
  some.add(all, at_once.gains() / 2, {});
  EXPECT_GE(some.gains(), at_once.gains() / 2);
  EXPECT_LT(some.gains(), at_once.gains());
}

// Deficits 2 and 3 of two members; the first is used by three CPVs.
TEST(TightConstraints, AreThoseWithLeastToSpare) {
  const auto problem = make_problem({-1, 0, 0}, {{1, 1.0, {{0, {4.0}}, {1, {2.1}}, {2, {3.0}}}}, {2, 1.0, {{2, {3.0}}}}}, {2.0, 2.0, 3.0});
  TightConstraints rows(problem);
  const Columns columns(problem, TreeOrder(problem.parent));
  for (std::uint32_t p = 0; p < 3; ++p) {
    std::vector<Serving> all;
    columns.read(p, all);
    rows.see(p, all);
  }
  rows.sort();
  EXPECT_EQ(rows.most(), 3U);
  EXPECT_EQ(rows.tightest(1), (std::vector<std::uint32_t>{1, 2}));  // covered 1.05 times; 2 times, all that the second member has
  EXPECT_EQ(rows.tightest(3), (std::vector<std::uint32_t>{1, 0, 2}));
}

TEST(MemoryLowerBound, ByTheTightConstraintsOfTheOptimumIsNearIt) {
  double sum_ratio = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto problem = random_problem(seed, {.cpvs = 3, .stages = seed % 2 == 0 ? 1U : 3U, .integers = false});
    const auto exact = BruteForce(problem).optimum();
    if (!exact) continue;
    Selection known;
    known.chosen = exact->set;
    const double bound = memory_lower_bound(problem, known, {}, {});
    ASSERT_LE(bound, exact->bytes) << "seed " << seed;
    sum_ratio += bound / exact->bytes;
    ++count;
  }
  EXPECT_GT(count, 50);
  EXPECT_GT(sum_ratio / count, 0.8);
}

// Whatever is said to be known, and wherever a limit ends the search.
TEST(MemoryLowerBound, IsOneWhateverIsKnown) {
  Rng rng(7);
  int count = 0, above_zero = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto problem = random_problem(seed, {.cpvs = 3, .stages = seed % 2 == 0 ? 1U : 3U, .integers = false});
    const auto exact = BruteForce(problem).optimum();
    if (!exact) continue;
    Selection known;
    for (std::uint32_t c = 0; c < problem.candidate_count(); ++c)
      if (rng.below(3) == 0) known.chosen.push_back(c);
    const double bound = memory_lower_bound(problem, known, {.most_gains = rng.below(2000)}, {});
    ASSERT_LE(bound, exact->bytes) << "seed " << seed;
    above_zero += bound > 0.0 ? 1 : 0;
    ++count;
  }
  EXPECT_GT(count, 50);
  EXPECT_GT(above_zero, 30);
  const auto problem = random_problem(1, {});
  EXPECT_EQ(memory_lower_bound(problem, {}, {}, {}), 0.0);
  Selection unknown;
  unknown.chosen = {problem.candidate_count()};
  EXPECT_THROW((void)memory_lower_bound(problem, unknown, {}, {}), Failure);
}

TEST(LagrangianBound, TightForOneCpvOfEqualCandidates) {
  // Deficit 3 and gains 1 at 2 bytes: the relaxation is exact at 6 bytes.
  std::vector<Row> rows;
  std::vector<std::int32_t> parent{-1};
  for (std::uint32_t c = 0; c < 5; ++c) {
    parent.push_back(0);
    rows.push_back({c + 1, 2.0, {{0, {1.0}}}});
  }
  const double bound = bound_of(make_problem(parent, rows, {3.0}), 6.0, 0);
  EXPECT_LE(bound, 6.0);
  EXPECT_GT(bound, 6.0 * (1.0 - 1e-9));
}

TEST(LagrangianBound, AntichainsAreWhole) {
  // Deficit 3, gains 2 at 2 bytes each, two of them: fractions would do with 3 bytes, the optimum is 4.
  const auto problem = make_problem({-1, 0, 0}, {{1, 2.0, {{0, {2.0}}}}, {2, 2.0, {{0, {2.0}}}}}, {3.0});
  const double bound = bound_of(problem, 4.0, 200);
  EXPECT_LE(bound, 4.0);
  EXPECT_GT(bound, 3.99);
}

TEST(LagrangianBound, ImpostorsOfOneClusterDoNotAddUp) {
  // Cluster 1 gains 2 of the deficit 4, whichever of its three impostors of one byte stands for it: the other cluster's 10 bytes are
  // needed.
  const auto problem =
      make_problem({-1, 0, 0}, {{1, 1.0, {{0, {2.0}}}}, {1, 1.0, {{0, {2.0}}}}, {1, 1.0, {{0, {2.0}}}}, {2, 10.0, {{0, {2.0}}}}}, {4.0});
  const double bound = bound_of(problem, 11.0, 10);
  EXPECT_LE(bound, 11.0);
  EXPECT_GT(bound, 11.0 * (1.0 - 1e-9));
}

TEST(LagrangianBound, NestedImpostorsDoNotAddUp) {
  // The whole gains 5 for a byte, its parts 3 each for 4 bytes: 6 needs both parts, and the whole is of no use.
  const auto problem = make_problem({-1, 0, 0}, {{0, 1.0, {{0, {5.0}}}}, {1, 4.0, {{0, {3.0}}}}, {2, 4.0, {{0, {3.0}}}}}, {6.0});
  const double bound = bound_of(problem, 8.0, 100);
  EXPECT_LE(bound, 8.0);
  EXPECT_GT(bound, 7.99);
}

TEST(LagrangianBound, OneImpostorIsPaidOnceByManyCpvs) {
  // One impostor of 9 bytes serves three CPVs; each could also have one of its own at 4.
  std::vector<Row> rows{{0, 9.0, {{0, {1.0}}, {1, {1.0}}, {2, {1.0}}}}};
  for (std::uint32_t p = 0; p < 3; ++p) rows.push_back({0, 4.0, {{p, {1.0}}}});
  const double bound = bound_of(make_problem({-1}, rows, {1.0, 1.0, 1.0}), 9.0, 50);
  EXPECT_LE(bound, 9.0);
  EXPECT_GT(bound, 8.99);
}

TEST(LagrangianBound, MoreStepsNeverLowerIt) {
  const auto problem = random_problem(5, {.nodes = 60, .candidates = 200, .cpvs = 40, .integers = false, .demand = 60.0});
  double previous = 0.0;
  for (const int steps : {0, 1, 10, 50, 200}) {
    const double bound = bound_of(problem, 500.0, steps);
    EXPECT_GE(bound, previous) << steps << " steps";
    previous = bound;
  }
  EXPECT_GT(previous, bound_of(problem, 500.0, 0));
}

TEST(LagrangianBound, IgnoredCpvsDoNotCount) {
  const auto problem = make_problem({-1, 0, 0}, {{1, 2.0, {{0, {2.0}}}}, {2, 7.0, {{1, {2.0}}}}}, {2.0, 2.0});
  EXPECT_NEAR(bound_by(problem, constraints_of(problem, {false, false}), 9.0, 100), 9.0, 1e-6);
  EXPECT_NEAR(bound_by(problem, constraints_of(problem, {false, true}), 2.0, 100), 2.0, 1e-6);
}

}  // namespace
}  // namespace standin::test
