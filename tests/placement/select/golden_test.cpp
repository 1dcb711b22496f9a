// Greedy orders, exact optima and bounds against the recorded instances (tests/golden/greedy_instances.json).
//
// The vectors list a "safe" and a "mixed" order; we implement the safe rule. Where a negative gain makes mixed pick more, our stall repair
// solves the same CPVs.
#include "tests/support/golden.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "placement/select/greedy.h"
#include "tests/support/selection_brute_force.h"
#include "tests/support/selection_instances.h"

namespace standin::test {
namespace {

SelectionProblem problem_of(const nlohmann::json& in) {
  std::vector<std::int32_t> parent;
  for (const auto& value : in.at("parent")) parent.push_back(value.is_null() ? -1 : value.get<std::int32_t>());
  std::vector<Row> rows;
  for (const auto& candidate : in.at("candidates")) {
    Row row{candidate.at("node").get<std::uint32_t>(), candidate.at("mem").get<double>(), {}};
    for (const auto& [cpv, gain] : candidate.at("gain").items())
      row.gain[static_cast<std::uint32_t>(std::stoul(cpv))] = gain.get<std::vector<double>>();
    rows.push_back(row);
  }
  const auto& deficits = in.at("deficit");
  std::vector<double> deficit;
  for (std::size_t p = 0; p < deficits.size(); ++p)
    for (const auto& value : deficits.at(std::to_string(p))) deficit.push_back(value.get<double>());
  return make_problem(parent, rows, deficit, static_cast<std::uint32_t>(deficit.size() / deficits.size()));
}

TEST(GreedyInstances, SafeOrderIsReproducedLazilyAndPlainly) {
  for (const auto& vector : golden_cases("greedy_instances.json")) {
    const auto problem = problem_of(vector.at("in"));
    const auto& safe = vector.at("out").at("greedy").at("safe");
    const auto expected = safe.at("greedy_order").get<std::vector<std::uint32_t>>();
    const TreeOrder order(problem.parent);
    const Columns columns(problem, order);
    const std::vector<bool> none(problem.candidate_count(), false);
    for (const bool lazy : {true, false}) {
      GreedyState state(problem, columns, {});
      const auto picks = lazy ? pick_lazily(state, none, 1, {}) : pick_plainly(state, none, {});
      EXPECT_EQ(picks.order, expected) << vector.dump();
      EXPECT_EQ(state.all_met(), safe.at("complete").get<bool>());
    }
  }
}

TEST(GreedyInstances, OptimumBoundAndSelectionAgree) {
  for (const auto& vector : golden_cases("greedy_instances.json")) {
    const auto problem = problem_of(vector.at("in"));
    const auto& out = vector.at("out");
    const auto exact = BruteForce(problem).optimum();
    ASSERT_EQ(exact.has_value(), !out.at("exact_memory").is_null()) << vector.dump();
    const auto selection = select_impostors(problem, {}, {}, {});
    EXPECT_EQ(selection.summary.unmet.empty(), exact.has_value()) << vector.dump();
    if (!exact) continue;
    EXPECT_DOUBLE_EQ(exact->bytes, out.at("exact_memory").get<double>());
    EXPECT_LE(selection.summary.lower_bound_bytes, exact->bytes);
    EXPECT_GE(selection.summary.bytes, exact->bytes);
    EXPECT_GT(selection.summary.lower_bound_bytes, 0.0);
    const auto& safe = out.at("greedy").at("safe");
    if (safe.at("complete").get<bool>()) {
      EXPECT_DOUBLE_EQ(selection.summary.bytes_greedy, safe.at("memory").get<double>());
      EXPECT_DOUBLE_EQ(selection.summary.bytes, safe.at("after_reverse_delete").get<double>());
    }
  }
}

}  // namespace
}  // namespace standin::test
