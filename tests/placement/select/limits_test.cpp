// Limits: what a selection that must stop says, and what holds of it all the same.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

SelectionProblem instance(std::uint64_t seed) {
  return random_factored_problem(seed, {.nodes = 25, .candidates = 300, .cells = 12, .cpvs_per_cell = 3, .demand = 25.0});
}

SelectionConfig all_steps(std::uint64_t most_gains = UINT64_MAX) {
  return {.guided_sweeps = 3, .exchange_rounds = 2, .recreate_trials = 50, .bound_iterations = 20, .most_gains = most_gains};
}

bool names(const SelectionSummary& summary, const std::string& step) {
  return std::ranges::any_of(summary.cut_short, [&](const CutShort& cut) { return cut.step == step; });
}

/// Every CPV is met by an antichain of what is chosen, or named with what it misses.
void check_says_what_is_unmet(const SelectionProblem& problem, const Selection& selection) {
  const BruteForce oracle(problem);
  std::size_t named = 0;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    EXPECT_TRUE(oracle.is_antichain(selection.assigned[p]));
    const double missing = problem.deficit[p] > 0.0 ? oracle.violation(selection.assigned[p], p) : 0.0;
    const auto found = std::ranges::find(selection.summary.unmet, p, &Shortfall::cpv);
    EXPECT_EQ(missing > 0.0, found != selection.summary.unmet.end()) << "CPV " << p;
    named += found != selection.summary.unmet.end() ? 1 : 0;
  }
  EXPECT_EQ(named, selection.summary.unmet.size());
}

TEST(SelectionLimits, AnyWorkLimitLeavesAnHonestSelection) {
  int cut_in_greedy = 0, cut_later = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto problem = instance(seed);
    const auto whole = select_impostors(problem, all_steps(), {}, {});
    EXPECT_TRUE(whole.summary.cut_short.empty());
    for (double share = 0.0; share < 0.95; share += 0.1) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", share " + std::to_string(share));
      const auto limit = static_cast<std::uint64_t>(share * static_cast<double>(whole.summary.gains));
      const auto cut = select_impostors(problem, all_steps(limit), {}, {});
      check_says_what_is_unmet(problem, cut);
      EXPECT_FALSE(cut.summary.cut_short.empty());
      EXPECT_NE(cut.summary.message.find("work limit of " + std::to_string(limit) + " gains"), std::string::npos);
      if (cut.summary.stop == SelectionSummary::Stop::kGreedyCutShort) {
        EXPECT_TRUE(names(cut.summary, "greedy"));
        ++cut_in_greedy;
      } else {
        EXPECT_EQ(cut.summary.unmet.size(), whole.summary.unmet.size());
        EXPECT_GE(cut.summary.bytes, whole.summary.lower_bound_bytes);
        ++cut_later;
      }
    }
  }
  EXPECT_GT(cut_in_greedy, 0);
  EXPECT_GT(cut_later, 0);
}

TEST(SelectionLimits, TheSameLimitGivesTheSameSelectionOnAnyThreads) {
  const auto problem = instance(3);
  const auto whole = select_impostors(problem, all_steps(), {}, {});
  SelectionConfig config = all_steps(whole.summary.gains / 2);
  const auto one = select_impostors(problem, config, {}, {});
  config.threads = 4;
  const auto four = select_impostors(problem, config, {}, {});
  EXPECT_EQ(one.chosen, four.chosen);
  EXPECT_EQ(one.assigned, four.assigned);
  EXPECT_EQ(one.summary.gains, four.summary.gains);
  EXPECT_EQ(one.summary.message, four.summary.message);
}

TEST(SelectionLimits, AnAmpleLimitChangesNothing) {
  const auto problem = instance(4);
  const auto whole = select_impostors(problem, all_steps(), {}, {});
  const auto ample = select_impostors(problem, all_steps(whole.summary.gains + 1), {}, {});
  EXPECT_EQ(ample.chosen, whole.chosen);
  EXPECT_EQ(ample.summary.lower_bound_bytes, whole.summary.lower_bound_bytes);
  EXPECT_TRUE(ample.summary.cut_short.empty());
}

// As a job selects: whatever a limit cuts short in the second greedy is named, though no step comes after it.
TEST(SelectionLimits, ASecondGreedyCutShortIsNamed) {
  const auto problem = instance(3);
  SelectionConfig config{.guided_sweeps = 3, .bound_iterations = 0};
  const auto whole = select_impostors(problem, config, {}, {});
  ASSERT_TRUE(whole.summary.cut_short.empty());
  for (std::uint64_t limit = whole.summary.gains / 3; limit < whole.summary.gains; limit += whole.summary.gains / 97 + 1) {
    config.most_gains = limit;
    EXPECT_FALSE(select_impostors(problem, config, {}, {}).summary.cut_short.empty()) << "limit " << limit << " of " << whole.summary.gains;
  }
}

TEST(SelectionLimits, NothingIsToldOfAGreedyCutShortAndABoundSurvives) {
  const auto problem = instance(3);
  std::vector<std::string> told;
  SelectionConfig config{.guided_sweeps = 3, .bound_iterations = 0};
  config.on_step = [&](const SelectionStep& step) { told.push_back(step.name); };
  const auto whole = select_impostors(problem, config, {}, {});
  ASSERT_EQ(told, (std::vector<std::string>{"greedy", "reverse-delete", "second greedy"}));
  ASSERT_GT(whole.summary.priced_bound_bytes, 0.0);

  told.clear();
  config.most_gains = whole.summary.gains - 1;
  const auto almost = select_impostors(problem, config, {}, {});
  EXPECT_EQ(told.size(), 3U);
  EXPECT_EQ(almost.summary.priced_bound_bytes, whole.summary.priced_bound_bytes) << "found before what was cut short";

  told.clear();
  config.most_gains = 1;
  EXPECT_EQ(select_impostors(problem, config, {}, {}).summary.stop, SelectionSummary::Stop::kGreedyCutShort);
  EXPECT_TRUE(told.empty());

  config = {.guided_sweeps = 0, .on_step = config.on_step};
  EXPECT_EQ(select_impostors(problem, config, {}, {}).summary.priced_bound_bytes, 0.0);
  EXPECT_EQ(told, (std::vector<std::string>{"greedy", "reverse-delete"}));
}

TEST(SelectionLimits, SelectionsShareALimit) {
  const auto problem = instance(4);
  const auto whole = select_impostors(problem, all_steps(), {}, {});
  SelectionConfig config = all_steps(whole.summary.gains + 100);
  config.gains_before = 100;
  const auto second = select_impostors(problem, config, {}, {});
  EXPECT_EQ(second.chosen, whole.chosen);
  EXPECT_EQ(second.summary.gains, whole.summary.gains);
  config.gains_before = config.most_gains;
  EXPECT_EQ(select_impostors(problem, config, {}, {}).summary.stop, SelectionSummary::Stop::kGreedyCutShort);
}

TEST(SelectionLimits, ADeadlineIsAskedForAndNamed) {
  const auto problem = instance(5);
  SelectionConfig config = all_steps();
  config.out_of_time = [] { return true; };
  const auto at_once = select_impostors(problem, config, {}, {});
  EXPECT_EQ(at_once.summary.stop, SelectionSummary::Stop::kGreedyCutShort);
  check_says_what_is_unmet(problem, at_once);
  EXPECT_NE(at_once.summary.message.find("deadline"), std::string::npos);

  // Time enough for the greedy.
  int asked = 0;
  config.out_of_time = [&] { return ++asked > 2000; };
  const auto later = select_impostors(problem, config, {}, {});
  EXPECT_NE(later.summary.stop, SelectionSummary::Stop::kGreedyCutShort);
  check_says_what_is_unmet(problem, later);
}

}  // namespace
}  // namespace standin::test
