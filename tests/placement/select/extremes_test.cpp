// Sizes and values at the ends of their ranges.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "placement/select/fewest_shown.h"
#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

using Ids = std::vector<std::uint32_t>;

TEST(SelectExtremes, DeficitsAndBytesOverTwentyFourOrders) {
  const auto problem = make_problem(
      {-1, 0, 0, 0}, {{1, 1.0, {{0, {1e-12}}}}, {2, 1e12, {{1, {1e12}}}}, {3, 1e12, {{0, {1e12}}, {1, {1.0}}}}}, {1e-12, 1e12});
  const auto selection = select_impostors(problem, {}, {}, {});
  EXPECT_EQ(selection.chosen, (Ids{0, 1}));
  EXPECT_TRUE(selection.summary.unmet.empty());
  EXPECT_LE(selection.summary.lower_bound_bytes, 1e12 + 1.0);
  EXPECT_GE(selection.summary.lower_bound_bytes, 0.99e12);
}

TEST(SelectExtremes, OneUlpTooLittleIsUnreachable) {
  const double deficit = 0.3;
  const double less = std::nextafter(deficit, 0.0);
  const auto enough = select_impostors(make_problem({-1}, {{0, 1.0, {{0, {deficit}}}}}, {deficit}), {}, {}, {});
  EXPECT_EQ(enough.chosen, (Ids{0}));
  const auto missed = select_impostors(make_problem({-1}, {{0, 1.0, {{0, {less}}}}}, {deficit}), {}, {}, {});
  EXPECT_TRUE(missed.chosen.empty());
  ASSERT_EQ(missed.summary.unmet.size(), 1U);
  EXPECT_EQ(missed.summary.unmet[0].residual, deficit - less);
  EXPECT_TRUE(missed.assigned[0].empty());  // nothing was bought, so nothing is drawn
}

TEST(SelectExtremes, SumsDoNotDependOnRounding) {
  // In double arithmetic 0.1 added ten times falls short of 1.0 by an ulp; the doubles themselves add up to a little more than 1.
  std::vector<Row> rows;
  std::vector<std::int32_t> parent{-1};
  for (std::uint32_t c = 0; c < 12; ++c) {
    parent.push_back(0);
    rows.push_back({c + 1, 1.0, {{0, {0.1}}}});
  }
  const auto problem = make_problem(parent, rows, {1.0});
  const auto selection = select_impostors(problem, {}, {}, {});
  EXPECT_EQ(BruteForce(problem).violation(selection.assigned[0], 0), 0.0);
  EXPECT_EQ(selection.chosen.size(), 10U);
}

TEST(SelectExtremes, AllTiedAndZeroGains) {
  std::vector<Row> rows;
  std::vector<std::int32_t> parent{-1};
  for (std::uint32_t c = 0; c < 100; ++c) {
    parent.push_back(0);
    rows.push_back({c + 1, 0.1, {{0, {0.3}}, {1, {0.3}}, {2, {0.0}}}});
  }
  const auto selection = select_impostors(make_problem(parent, rows, {2.95, 2.95, 1.0}), {}, {}, {});
  for (std::uint32_t c = 0; c < selection.chosen.size(); ++c) EXPECT_EQ(selection.chosen[c], c);  // the lowest ids
  EXPECT_EQ(selection.chosen.size(), 10U);
  ASSERT_EQ(selection.summary.unmet.size(), 1U);
  EXPECT_EQ(selection.summary.unmet[0].residual, 1.0);
}

TEST(SelectExtremes, HierarchyTenThousandDeep) {
  // A chain of clusters, each with an impostor a little better and dearer than the one below; two leaves hang off the bottom.
  constexpr std::uint32_t kDepth = 10'000;
  std::vector<std::int32_t> parent;
  std::vector<Row> rows;
  for (std::uint32_t n = 0; n < kDepth; ++n) {
    parent.push_back(static_cast<std::int32_t>(n) - 1);
    rows.push_back({n, 2.0 * (kDepth - n) + 10.0, {{0, {static_cast<double>(kDepth - n)}}}});
  }
  const auto bottom = static_cast<std::int32_t>(kDepth - 1);
  parent.insert(parent.end(), {bottom, bottom});
  rows.push_back({kDepth, 1e6, {{0, {kDepth * 0.75}}}});
  rows.push_back({kDepth + 1, 1e6, {{0, {kDepth * 0.75}}}});
  const auto reachable = select_impostors(make_problem(parent, rows, {static_cast<double>(kDepth)}), {}, {}, {});
  EXPECT_EQ(reachable.chosen, (Ids{0}));
  const auto only_leaves = select_impostors(make_problem(parent, rows, {kDepth * 1.5}), {}, {}, {});
  EXPECT_EQ(only_leaves.chosen, (Ids{kDepth, kDepth + 1}));
  const auto too_much = select_impostors(make_problem(parent, rows, {kDepth * 1.5 + 1.0}), {}, {}, {});
  ASSERT_EQ(too_much.summary.unmet.size(), 1U);
  EXPECT_DOUBLE_EQ(too_much.summary.unmet[0].residual, 1.0);
}

TEST(SelectExtremes, ManyRoots) {
  const auto problem = make_problem({-1, -1, 0, 1}, {{2, 1.0, {{0, {1.0}}}}, {3, 1.0, {{0, {1.0}}}}, {0, 5.0, {{0, {1.5}}}}}, {2.0});
  EXPECT_EQ(select_impostors(problem, {}, {}, {}).chosen, (Ids{0, 1}));
}

// Whatever the steps, what is reachable is met, and no bound exceeds the bytes.
void expect_every_step_holds(const SelectionProblem& problem, std::size_t unmet) {
  for (const SelectionConfig& config :
       {SelectionConfig{.bound_iterations = 20},
        SelectionConfig{.guided_sweeps = 4, .exchange_rounds = 1, .recreate_trials = 20, .bound_iterations = 20}}) {
    Selection selection = select_impostors(problem, config, {}, {});
    EXPECT_EQ(selection.summary.unmet.size(), unmet);
    EXPECT_LE(selection.summary.lower_bound_bytes, selection.summary.bytes);
    EXPECT_GE(selection.summary.lower_bound_bytes, 0.0);
    EXPECT_TRUE(std::isfinite(selection.summary.lower_bound_bytes));
    const ShownImpostors shown = show_fewest(problem, selection, {});
    EXPECT_LE(shown.after, shown.before);
  }
}

TEST(SelectExtremes, BytesOverTwelveOrders) {
  // Eight clusters, bytes 1 to 1e12; each CPV can be met by a cheap pair or by a dear one.
  std::vector<std::int32_t> parent{-1};
  std::vector<Row> rows;
  for (std::uint32_t c = 0; c < 8; ++c) {
    parent.push_back(0);
    rows.push_back({c + 1, std::pow(10.0, 12.0 * c / 7.0), {{c % 4, {1.0}}, {(c + 1) % 4, {1.0}}}});
  }
  const auto problem = make_problem(parent, rows, {2.0, 2.0, 2.0, 2.0});
  expect_every_step_holds(problem, 0);
  const auto selection = select_impostors(problem, {.bound_iterations = 50}, {}, {});
  EXPECT_EQ(selection.summary.bytes, BruteForce(problem).optimum()->bytes);
  EXPECT_GT(selection.summary.lower_bound_bytes, 0.99 * selection.summary.bytes);
}

TEST(SelectExtremes, DeficitsOverTwentyFourOrdersInEveryStep) {
  const auto problem = make_problem(
      {-1, 0, 0, 0}, {{1, 1.0, {{0, {1e-12}}}}, {2, 1e12, {{1, {1e12}}}}, {3, 1e12, {{0, {1e12}}, {1, {1.0}}}}}, {1e-12, 1e12});
  expect_every_step_holds(problem, 0);
}

TEST(SelectExtremes, GainsBelowWhatDoublesTellApart) {
  // A deficit of the smallest normal double, and one that gains cannot add up to for being denormal.
  const double tiny = std::numeric_limits<double>::min();
  expect_every_step_holds(make_problem({-1, 0}, {{1, 1.0, {{0, {tiny}}, {1, {tiny / 4.0}}}}}, {tiny, tiny}), 1);
}

TEST(SelectExtremes, OneCpv) {
  const auto problem = make_problem({-1, 0, 0}, {{1, 3.0, {{0, {2.0}}}}, {2, 5.0, {{0, {3.0}}}}, {0, 9.0, {{0, {5.0}}}}}, {4.0});
  expect_every_step_holds(problem, 0);
  const auto selection = select_impostors(problem, {.guided_sweeps = 4, .recreate_trials = 10}, {}, {});
  EXPECT_EQ(selection.summary.bytes, 8.0);
}

TEST(SelectExtremes, OneCandidateServesAll) {
  constexpr std::uint32_t kCpvs = 2'000;
  std::vector<Row> rows(1, Row{0, 1000.0, {}});
  for (std::uint32_t p = 0; p < kCpvs; ++p) {
    rows[0].gain[p] = {1.0};
    rows.push_back({0, 1.0, {{p, {1.0}}}});
  }
  const auto problem = make_problem({-1}, rows, std::vector<double>(kCpvs, 1.0));
  expect_every_step_holds(problem, 0);
  const auto selection = select_impostors(problem, {.bound_iterations = 20}, {}, {});
  EXPECT_EQ(selection.chosen, (Ids{0}));
  EXPECT_GT(selection.summary.lower_bound_bytes, 999.0);
}

TEST(SelectExtremes, AllTiedInEveryStep) {
  std::vector<Row> rows;
  std::vector<std::int32_t> parent{-1};
  for (std::uint32_t c = 0; c < 100; ++c) {
    parent.push_back(0);
    rows.push_back({c + 1, 0.1, {{0, {0.3}}, {1, {0.3}}, {2, {0.0}}}});
  }
  expect_every_step_holds(make_problem(parent, rows, {2.95, 2.95, 1.0}), 1);
}

TEST(SelectExtremes, InfeasibleByOneUlpInEveryStep) {
  expect_every_step_holds(make_problem({-1}, {{0, 1.0, {{0, {std::nextafter(0.3, 0.0)}}}}}, {0.3}), 1);
}

TEST(SelectExtremes, OneOfAMillionCpvsIsSlow) {
  constexpr std::uint32_t kCpvs = 1'000'000;
  SelectionProblem problem;
  problem.parent = {-1};
  problem.deficit.assign(kCpvs, -1.0);
  problem.deficit[777'777] = 1.0;
  problem.form.assign(kCpvs, 0);
  problem.cpv.resize(kCpvs);
  std::iota(problem.cpv.begin(), problem.cpv.end(), 0U);
  problem.worth.assign(kCpvs, 2.0);
  problem.block_offset.push_back(kCpvs);
  problem.node = {0, 0};
  problem.bytes = {7.0, 8.0};
  problem.cost = {0.5, 0.5};
  problem.run_offset = {0, 1, 2};
  problem.runs = {{0, 1}, {0, 1}};
  expect_every_step_holds(problem, 0);
  const auto selection = select_impostors(problem, {}, {}, {});
  EXPECT_EQ(selection.chosen, (Ids{0}));
  EXPECT_EQ(selection.assigned[777'777], (Ids{0}));
  EXPECT_TRUE(selection.assigned[777'776].empty());
  EXPECT_GT(selection.summary.lower_bound_bytes, 6.99);
}

TEST(SelectExtremes, HierarchyTenThousandDeepInEveryStep) {
  // As above, for twenty CPVs: a step that walked the chain for each of its nodes would look at 2e9 nodes a sweep.
  constexpr std::uint32_t kDepth = 10'000;
  constexpr std::uint32_t kCpvs = 20;
  std::vector<std::int32_t> parent;
  std::vector<Row> rows;
  for (std::uint32_t n = 0; n < kDepth; ++n) {
    parent.push_back(static_cast<std::int32_t>(n) - 1);
    rows.push_back({n, 2.0 * (kDepth - n) + 10.0, {}});
    for (std::uint32_t p = 0; p < kCpvs; ++p) rows.back().gain[p] = {static_cast<double>(kDepth - n)};
  }
  expect_every_step_holds(make_problem(parent, rows, std::vector<double>(kCpvs, static_cast<double>(kDepth - 5))), 0);
}

}  // namespace
}  // namespace standin::test
