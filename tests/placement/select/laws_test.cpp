// What any selector must keep, on hundreds of small random instances, against the brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numeric>
#include <utility>

#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

using Selector = std::function<Selection(const SelectionProblem&)>;

std::set<std::uint32_t> unreachable(const SelectionProblem& problem, const BruteForce& oracle) {
  std::vector<std::uint32_t> all(problem.candidate_count());
  std::iota(all.begin(), all.end(), 0U);
  std::set<std::uint32_t> result;
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p)
    if (oracle.least_violation(all, p) > 0.0) result.insert(p);
  return result;
}

void check_unmet(const SelectionProblem& problem, const BruteForce& oracle, const Selection& selection) {
  std::vector<std::uint32_t> all(problem.candidate_count());
  std::iota(all.begin(), all.end(), 0U);
  std::set<std::uint32_t> unmet;
  for (const auto& shortfall : selection.summary.unmet) {
    unmet.insert(shortfall.cpv);
    EXPECT_DOUBLE_EQ(shortfall.residual, oracle.least_violation(all, shortfall.cpv));
  }
  EXPECT_EQ(unmet, unreachable(problem, oracle));
  EXPECT_EQ(selection.summary.stop == SelectionSummary::Stop::kAllMet, unmet.empty());
}

void check_assignments(const SelectionProblem& problem, const BruteForce& oracle, const Selection& selection) {
  const auto blocked = unreachable(problem, oracle);
  ASSERT_EQ(selection.assigned.size(), problem.cpv_count());
  EXPECT_TRUE(std::is_sorted(selection.chosen.begin(), selection.chosen.end()));
  for (std::uint32_t p = 0; p < problem.cpv_count(); ++p) {
    const auto& antichain = selection.assigned[p];
    EXPECT_TRUE(std::is_sorted(antichain.begin(), antichain.end()));
    EXPECT_TRUE(oracle.is_antichain(antichain));
    EXPECT_TRUE(std::includes(selection.chosen.begin(), selection.chosen.end(), antichain.begin(), antichain.end()));
    for (const auto c : antichain) EXPECT_TRUE(oracle.serves(c, p));
    if (blocked.count(p) == 0) {
      EXPECT_EQ(oracle.violation(antichain, p), 0.0) << "CPV " << p;
    }
  }
}

/// No member can go: what reverse-delete promises.
void check_minimal(const SelectionProblem& problem, const BruteForce& oracle, const Selection& selection) {
  const auto blocked = unreachable(problem, oracle);
  for (const auto left_out : selection.chosen) {
    auto fewer = selection.chosen;
    std::erase(fewer, left_out);
    EXPECT_FALSE(oracle.meets_all(fewer, blocked)) << "candidate " << left_out << " is not needed";
  }
}

void check_selector_laws(const SelectionProblem& problem, const Selector& select, double& worst_ratio) {
  const BruteForce oracle(problem);
  const auto selection = select(problem);
  check_unmet(problem, oracle, selection);
  check_assignments(problem, oracle, selection);
  check_minimal(problem, oracle, selection);
  const auto exact = oracle.optimum(unreachable(problem, oracle));
  ASSERT_TRUE(exact.has_value());
  const auto& summary = selection.summary;
  EXPECT_LE(summary.lower_bound_bytes, exact->bytes);
  EXPECT_LE(summary.priced_bound_bytes, exact->bytes);
  EXPECT_LE(exact->bytes, summary.bytes * (1.0 + 1e-12));
  EXPECT_LE(summary.bytes, summary.bytes_greedy);
  if (exact->bytes > 0.0) worst_ratio = std::max(worst_ratio, summary.bytes / exact->bytes);
}

/// Checks the problems of seeds 1, 2, .. `seeds`; returns how many kept every law, stopping at the first that does not.
std::uint64_t kept_by(std::uint64_t seeds, const std::function<SelectionProblem(std::uint64_t)>& problem_of,
                      const SelectionConfig& config = {}) {
  double worst_ratio = 1.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    check_selector_laws(
        problem_of(seed), [&](const auto& problem) { return select_impostors(problem, config, {}, {}); }, worst_ratio);
    if (testing::Test::HasFailure()) return seed - 1;
  }
  std::printf("%lu instances, worst bytes / optimum %.3f\n", static_cast<unsigned long>(seeds), worst_ratio);
  return seeds;
}

TEST(ReverseDelete, LeftOutKeepsWhatTheGreedyPicked) {
  int dearer = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SelectionProblem problem = random_problem(seed, {});
    const BruteForce oracle(problem);
    const Selection kept = select_impostors(problem, {.reverse_delete = false}, {}, {});
    check_unmet(problem, oracle, kept);
    check_assignments(problem, oracle, kept);
    EXPECT_EQ(kept.summary.bytes, kept.summary.bytes_greedy);
    dearer += select_impostors(problem, {}, {}, {}).summary.bytes < kept.summary.bytes ? 1 : 0;
  }
  EXPECT_GT(dearer, 0);
}

std::function<SelectionProblem(std::uint64_t)> random_problems(const RandomShape& shape) {
  return [=](std::uint64_t seed) { return random_problem(seed, shape); };
}
std::function<SelectionProblem(std::uint64_t)> factored_problems(const FactoredShape& shape) {
  return [=](std::uint64_t seed) { return random_factored_problem(seed, shape); };
}

TEST(SelectorLaws, OneStage) {
  EXPECT_EQ(kept_by(250, random_problems({})), 250U);
}
TEST(SelectorLaws, OneStageReal) {
  EXPECT_EQ(kept_by(250, random_problems({.integers = false})), 250U);
}
TEST(SelectorLaws, ManyTies) {
  EXPECT_EQ(kept_by(250, random_problems({.ties = true})), 250U);
}
TEST(SelectorLaws, ThreeStages) {
  EXPECT_EQ(kept_by(150, random_problems({.stages = 3})), 150U);
}
TEST(SelectorLaws, ThreeStagesSomeGainsNegative) {
  EXPECT_EQ(kept_by(150, random_problems({.stages = 3, .negative = 0.4, .demand = 7.0})), 150U);
}
TEST(SelectorLaws, PlainGreedy) {
  EXPECT_EQ(kept_by(100, random_problems({}), {.lazy = false}), 100U);
}
TEST(SelectorLaws, Exchange) {
  EXPECT_EQ(kept_by(150, random_problems({}), {.exchange_rounds = 10}), 150U);
}
TEST(SelectorLaws, SecondGreedyAtPrices) {
  EXPECT_EQ(kept_by(150, random_problems({}), {.guided_sweeps = 4}), 150U);
  EXPECT_EQ(kept_by(100, random_problems({.stages = 3, .negative = 0.4, .demand = 7.0}), {.guided_sweeps = 4}), 100U);
}
TEST(SelectorLaws, RuinAndRecreate) {
  EXPECT_EQ(kept_by(150, random_problems({}), {.recreate_trials = 30}), 150U);
  EXPECT_EQ(kept_by(150, random_problems({.ties = true}), {.recreate_trials = 30}), 150U);
  EXPECT_EQ(kept_by(150, factored_problems({}), {.guided_sweeps = 4, .recreate_trials = 30}), 150U);
}
TEST(SelectorLaws, FactoredGains) {
  EXPECT_EQ(kept_by(250, factored_problems({})), 250U);
}
TEST(SelectorLaws, FactoredGainsInTwoStages) {
  EXPECT_EQ(kept_by(150, factored_problems({.stages = 2})), 150U);
}

TEST(SelectorLaws, ExchangeNeverCosts) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto problem = random_problem(seed, {.candidates = 14, .cpvs = 6});
    const auto without = select_impostors(problem, {}, {}, {});
    const auto with = select_impostors(problem, {.exchange_rounds = 5}, {}, {});
    EXPECT_LE(with.summary.bytes, without.summary.bytes) << "seed " << seed;
  }
}

TEST(SelectorLaws, RecreatingNeverCostsAndOftenPays) {
  int cheaper = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto problem = random_factored_problem(seed, {.nodes = 15, .candidates = 60, .cells = 8, .cpvs_per_cell = 3, .demand = 25.0});
    const auto without = select_impostors(problem, {.bound_iterations = 0}, {}, {});
    const auto guided = select_impostors(problem, {.guided_sweeps = 4, .bound_iterations = 0}, {}, {});
    const auto with = select_impostors(problem, {.guided_sweeps = 4, .recreate_trials = 200, .bound_iterations = 0}, {}, {});
    EXPECT_LE(guided.summary.bytes, without.summary.bytes) << "seed " << seed;
    EXPECT_LE(with.summary.bytes, guided.summary.bytes) << "seed " << seed;
    cheaper += with.summary.bytes < without.summary.bytes ? 1 : 0;
  }
  EXPECT_GT(cheaper, 50);
}

TEST(SelectorLaws, StepsAreToldAndNoneCosts) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto problem = random_factored_problem(seed, {.nodes = 15, .candidates = 60, .cells = 8, .cpvs_per_cell = 3, .demand = 25.0});
    std::vector<SelectionStep> steps;
    SelectionConfig config{.guided_sweeps = 4, .exchange_rounds = 2, .recreate_trials = 20};
    config.on_step = [&](const SelectionStep& step) { steps.push_back(step); };
    const auto found = select_impostors(problem, config, {}, {});
    std::vector<std::string> names;
    for (const auto& step : steps) names.push_back(step.name);
    ASSERT_EQ(names, (std::vector<std::string>{"greedy", "reverse-delete", "second greedy", "exchange", "ruin and recreate"}));
    for (std::size_t k = 1; k < steps.size(); ++k) EXPECT_LE(steps[k].bytes, steps[k - 1].bytes) << steps[k].name << ", seed " << seed;
    EXPECT_GT(steps[0].gains, 0U);
    EXPECT_GT(steps[2].gains, steps[1].gains) << "the second greedy looks at gains";
    EXPECT_EQ(steps.back().bytes, found.summary.bytes);
    EXPECT_GE(found.summary.priced_bound_bytes, 0.5 * found.summary.lower_bound_bytes) << "seed " << seed;
  }
}

TEST(SelectorLaws, FactoredAndExplicitGainsAreTheSameProblem) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    for (const std::uint32_t stages : {1U, 2U}) {
      const auto factored =
          random_factored_problem(seed, {.nodes = 15, .candidates = 60, .cells = 8, .cpvs_per_cell = 3, .stages = stages, .demand = 25.0});
      const auto written_out = make_problem(factored.parent, rows_of(factored), factored.deficit, stages);
      const auto a = select_impostors(factored, {.exchange_rounds = 1}, {}, {});
      const auto b = select_impostors(written_out, {.exchange_rounds = 1}, {}, {});
      ASSERT_EQ(a.chosen, b.chosen) << "seed " << seed << ", stages " << stages;
      ASSERT_EQ(a.assigned, b.assigned) << "seed " << seed << ", stages " << stages;
    }
  }
}

TEST(SelectorLaws, ThreadsDoNotMatter) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto problem = random_factored_problem(seed, {.nodes = 40, .candidates = 9000, .cells = 30, .demand = 60.0});
    const auto one = select_impostors(problem, {.guided_sweeps = 2, .recreate_trials = 10, .bound_iterations = 10}, {}, {});
    const auto four = select_impostors(problem, {.guided_sweeps = 2, .recreate_trials = 10, .bound_iterations = 10, .threads = 4}, {}, {});
    EXPECT_EQ(one.chosen, four.chosen) << "seed " << seed;
    EXPECT_EQ(one.summary.evaluations, four.summary.evaluations);
    EXPECT_EQ(one.summary.lower_bound_bytes, four.summary.lower_bound_bytes);
  }
}

TEST(SelectorLaws, OrderOfCpvsDoesNotMatterForExactGains) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto problem = random_problem(seed, {.nodes = 20, .candidates = 40, .cpvs = 8, .demand = 20.0});
    std::vector<Row> rows = rows_of(problem);
    for (Row& row : rows) {
      const auto gains = std::exchange(row.gain, {});
      for (const auto& [cpv, gain] : gains) row.gain[problem.cpv_count() - 1 - cpv] = gain;
    }
    const auto turned = make_problem(problem.parent, rows, std::vector<double>(problem.deficit.rbegin(), problem.deficit.rend()));
    const auto picked = select_impostors(problem, {.bound_iterations = 0}, {}, {});
    const auto picked_turned = select_impostors(turned, {.bound_iterations = 0}, {}, {});
    EXPECT_EQ(picked.summary.picked_by_greedy, picked_turned.summary.picked_by_greedy) << "seed " << seed;
    if (picked.summary.stalled == 0) {
      EXPECT_EQ(picked.summary.bytes_greedy, picked_turned.summary.bytes_greedy) << "seed " << seed;
    }
  }
}

TEST(BruteForceOracle, OptimumFallsWithTheBudgetAndWithMoreCandidates) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    auto problem = random_problem(seed, {});
    const auto strict = BruteForce(problem).optimum();
    auto rows = rows_of(problem);
    rows.pop_back();
    const auto fewer = make_problem(problem.parent, rows, problem.deficit);
    if (const auto exact = BruteForce(fewer).optimum()) {
      ASSERT_TRUE(strict.has_value());
      EXPECT_LE(strict->bytes, exact->bytes);
    }
    for (auto& deficit : problem.deficit) deficit -= 1.0;
    const auto relaxed = BruteForce(problem).optimum();
    if (strict) {
      EXPECT_LE(relaxed->bytes, strict->bytes);
    }
  }
}

}  // namespace
}  // namespace standin::test
