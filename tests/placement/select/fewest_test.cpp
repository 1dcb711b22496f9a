// Showing no more impostors than a region needs: the fewest, by trying every subset of the chosen set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "placement/select/fewest_shown.h"
#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

using Ids = std::vector<std::uint32_t>;

/// Size of the smallest antichain of the chosen set that meets the CPV.
std::size_t fewest_by_trying(const BruteForce& oracle, const Ids& chosen, std::uint32_t cpv) {
  std::size_t fewest = chosen.size() + 1;
  for (std::uint32_t mask = 0; mask < (1U << chosen.size()); ++mask) {
    Ids set;
    for (std::size_t i = 0; i < chosen.size(); ++i)
      if ((mask >> i & 1U) != 0) set.push_back(chosen[i]);
    const bool all_serve = std::ranges::all_of(set, [&](std::uint32_t c) { return oracle.serves(c, cpv); });
    if (set.size() < fewest && all_serve && oracle.is_antichain(set) && oracle.violation(set, cpv) == 0.0) fewest = set.size();
  }
  return fewest;
}

void check(const SelectionProblem& problem, bool exact, std::uint64_t& before, std::uint64_t& after) {
  const BruteForce oracle(problem);
  const Selection selection = select_impostors(problem, {.bound_iterations = 0}, {}, {});
  Selection shown = selection;
  const ShownImpostors counts = show_fewest(problem, shown, {});
  EXPECT_EQ(shown.chosen, selection.chosen);
  std::uint64_t sum = 0;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    sum += shown.assigned[p].size();
    EXPECT_TRUE(std::ranges::is_sorted(shown.assigned[p]));
    if (oracle.violation(selection.assigned[p], p) > 0.0) {
      EXPECT_EQ(shown.assigned[p], selection.assigned[p]) << "CPV " << p << " is not met: everything that helps is shown";
      continue;
    }
    EXPECT_EQ(oracle.violation(shown.assigned[p], p), 0.0) << "CPV " << p;
    EXPECT_TRUE(oracle.is_antichain(shown.assigned[p]));
    EXPECT_LE(shown.assigned[p].size(), selection.assigned[p].size());
    if (exact) {
      EXPECT_EQ(shown.assigned[p].size(), fewest_by_trying(oracle, selection.chosen, p)) << "CPV " << p;
    }
  }
  EXPECT_EQ(counts.after, sum);
  before += counts.before;
  after += counts.after;
}

TEST(ShowFewest, IsTheFewestOfAllSubsets) {
  std::uint64_t before = 0, after = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    check(random_problem(seed, {}), true, before, after);
    check(random_problem(seed, {.ties = true}), true, before, after);
    check(random_factored_problem(seed, {}), true, before, after);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_LT(after, before);
  std::printf("600 instances, %lu impostors shown before, %lu after\n", static_cast<unsigned long>(before),
              static_cast<unsigned long>(after));
}

TEST(ShowFewest, KeepsRegionsMetInSeveralStages) {
  std::uint64_t before = 0, after = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    check(random_problem(seed, {.stages = 3, .negative = 0.4, .demand = 7.0}), false, before, after);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_LT(after, before);
}

TEST(ShowFewest, ByHand) {
  // CPV 0 needs 3: candidate 2 alone does it, though all three gain 6. CPV 1 needs the two small ones.
  const auto problem = make_problem(
      {-1, 0, 0, 0}, {{1, 1.0, {{0, {1.0}}, {1, {4.0}}}}, {2, 1.0, {{0, {2.0}}, {1, {4.0}}}}, {3, 1.0, {{0, {3.0}}}}}, {3.0, 8.0});
  Selection selection;
  selection.chosen = {0, 1, 2};
  selection.assigned = {{0, 1, 2}, {0, 1}};
  const ShownImpostors shown = show_fewest(problem, selection, {});
  EXPECT_EQ(selection.assigned, (std::vector<Ids>{{2}, {0, 1}}));
  EXPECT_EQ(shown.before, 5U);
  EXPECT_EQ(shown.after, 3U);
}

}  // namespace
}  // namespace standin::test
