// Sizes and values at the ends of their ranges.
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace standin::test
