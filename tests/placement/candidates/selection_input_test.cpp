#include "placement/candidates/selection_input.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/placement/candidates/toy_world.h"

namespace standin::test {
namespace {

double cost_ms(const ToyWorld& world, const ImpostorCost& impostor, bool pixels_capped) {
  const Cost cost = world.model.cost(impostor_features_bound(impostor, world.camera));
  return pixels_capped ? cost.fixed_ms : cost.fixed_ms + cost.pixel_ms;
}

using Ids = std::vector<std::uint32_t>;

std::vector<Ids> served(const SelectionProblem& problem) {
  std::vector<Ids> cpvs(problem.candidate_count());
  for (std::uint32_t c = 0; c < cpvs.size(); ++c)
    problem.for_each_served(c, [&](std::uint32_t entry) { cpvs[c].push_back(problem.cpv[entry]); });
  return cpvs;
}

double gain(const SelectionProblem& problem, std::uint32_t candidate, std::uint32_t cpv) {
  double result = 0.0;
  problem.for_each_served(candidate, [&](std::uint32_t entry) {
    if (problem.cpv[entry] == cpv) result = problem.gain(candidate, entry, 0);
  });
  return result;
}

TEST(SelectionInput, GainsAndDeficitsByHand) {
  // Two objects beside each other, one cell with two CPVs: 5 + 2 ms (pixels counted) and 3 ms (pixels capped).
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0, 0.0, 0.0), Vec3(2.0)});
  world.add_object({Vec3(5.0, 0.0, 0.0), Vec3(7.0, 2.0, 2.0)});
  world.finish_objects();
  const auto cell = world.add_cell({0, {0, 0, 0}}, {Vec3(0.0, 1.0, 200.0), Vec3(10.0, 1.5, 210.0)});
  world.add_cpv(cell, {{0, 5.0}, {1, 2.0}}, 1.0, false);
  world.add_cpv(cell, {{1, 3.0}}, 4.0, true);

  CandidateSet set;
  const auto candidate = [&](std::uint32_t node, double bytes, double quads) {
    Candidate c;
    c.node = node;
    c.cells = {cell};
    c.bytes = bytes;
    c.cost = {quads, bytes / 4.0, 1e-3};
    set.candidates.push_back(c);
  };
  candidate(0, 4000.0, 10.0);
  candidate(world.hierarchy.leaf[0], 400.0, 1.0);
  candidate(world.hierarchy.leaf[1], 400.0, 1.0);
  candidate(world.hierarchy.leaf[1], 400.0, 2000.0);  // 4,000 triangles of 1 us: dearer than the object

  const auto problem = world.problem(set, 6.0, 0.5);
  EXPECT_EQ(problem.parent, (std::vector<std::int32_t>{-1, 0, 0}));
  EXPECT_NEAR(problem.deficit[0], 8.0 - 5.5, 1e-8);
  EXPECT_GT(problem.deficit[0], 8.0 - 5.5);
  EXPECT_NEAR(problem.deficit[1], 7.0 - 5.5, 1e-8);
  EXPECT_EQ(served(problem), (std::vector<Ids>{{0, 1}, {0}, {0, 1}, {}}));
  const auto& c = set.candidates;
  EXPECT_DOUBLE_EQ(gain(problem, 0, 0), 7.0 - cost_ms(world, c[0].cost, false));
  EXPECT_DOUBLE_EQ(gain(problem, 0, 1), 3.0 - cost_ms(world, c[0].cost, true));
  EXPECT_DOUBLE_EQ(gain(problem, 1, 0), 5.0 - cost_ms(world, c[1].cost, false));
  // One draw, two triangles, and the impostor's pixels, which no cap hides.
  const double pixels = impostor_features_bound(c[2].cost, world.camera)[Term::kImpostorPixels];
  EXPECT_GT(pixels, 0.0);
  EXPECT_DOUBLE_EQ(gain(problem, 2, 1), 3.0 - (0.01 + 2.0 * 1e-3 + pixels * 1e-6));

  // Baked: the second leaf turns out dearer, the dear one cheaper.
  auto repaired = problem;
  set_impostor(repaired, 2, 9000.0, {4000.0, 2250.0, 1e-3}, world.model, world.camera);
  set_impostor(repaired, 3, 100.0, {1.0, 25.0, 1e-3}, world.model, world.camera);
  EXPECT_EQ(repaired.bytes, (std::vector<double>{4000.0, 400.0, 9000.0, 100.0}));
  EXPECT_EQ(served(repaired), (std::vector<Ids>{{0, 1}, {0}, {}, {0, 1}}));
  set_budget(repaired, world.subdivision, {7.0, 0.0});
  EXPECT_NEAR(repaired.deficit[0], 8.0 - 7.0, 1e-8);
}

TEST(SelectionInput, DoesNotDependOnThreads) {
  auto world = random_world(7, 10, 40);
  const auto set = world.generate();
  const auto one = world.problem(set, 0.8);
  world.options.threads = 4;
  const auto four = world.problem(set, 0.8);
  EXPECT_EQ(one.block_offset, four.block_offset);
  EXPECT_EQ(one.cpv, four.cpv);
  EXPECT_EQ(one.worth, four.worth);
  EXPECT_EQ(one.cost, four.cost);
  EXPECT_EQ(served(one), served(four));
  EXPECT_EQ(one.candidate_count(), set.candidates.size());
}

TEST(SelectionInput, CandidatesServeWhatTheirCellsGain) {
  // Written out from the terms, candidate by candidate and region by region, against the factored problem.
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto world = random_world(seed, 8, 25);
    const auto set = world.generate();
    const auto problem = world.problem(set, 0.8);
    const auto actual = served(problem);
    for (std::uint32_t c = 0; c < set.candidates.size(); ++c) {
      const Candidate& candidate = set.candidates[c];
      std::map<std::uint32_t, double> expected;
      for (std::uint32_t p = 0; p < world.subdivision.cpvs.size(); ++p) {
        const Cpv& cpv = world.subdivision.cpvs[p];
        if (!std::binary_search(candidate.cells.begin(), candidate.cells.end(), cpv.cell)) continue;
        double sum_ms = 0.0;
        const HierarchyNode& node = world.hierarchy.nodes[candidate.node];
        for (const auto& term : world.subdivision.terms_of(cpv)) {
          const auto rank = world.hierarchy.rank[term.object];
          if (rank >= node.first && rank < node.first + node.count) sum_ms += term.predicted_ms;
        }
        if (const double gain_ms = sum_ms - cost_ms(world, candidate.cost, cpv.pixels_capped); gain_ms > 0.0) expected[p] = gain_ms;
      }
      ASSERT_EQ(actual[c].size(), expected.size()) << "seed " << seed << ", candidate " << c;
      for (const auto& [p, gain_ms] : expected) EXPECT_NEAR(gain(problem, c, p), gain_ms, 1e-12);
    }
  }
}

/// Time of a CPV once its impostors are drawn, added up object by object.
double time_after_ms(const ToyWorld& world, const CandidateSet& set, const Cpv& cpv, const std::vector<std::uint32_t>& impostors) {
  double sum_ms = cpv.constant_ms;
  for (const auto i : impostors) sum_ms += cost_ms(world, set.candidates[i].cost, cpv.pixels_capped);
  for (const auto& term : world.subdivision.terms_of(cpv)) {
    const bool replaced = std::any_of(impostors.begin(), impostors.end(), [&](auto i) {
      const auto& objects = set.candidates[i].objects;
      return std::binary_search(objects.begin(), objects.end(), term.object);
    });
    if (!replaced) sum_ms += term.predicted_ms;
  }
  return sum_ms;
}

TEST(SelectionInput, AsciiStreetIsSolved) {
  const auto world = ascii_world({"AB.......0123", "CD.......4567", "E........89.."}, 8.0);
  const auto set = world.generate();
  const auto reach = world.reach();
  const double reachable_ms = *std::max_element(reach.predicted_ms.begin(), reach.predicted_ms.end());
  EXPECT_LT(reachable_ms, 21.0);
  const double budget_ms = 0.5 * (reachable_ms + 21.0);
  const auto selection = select_impostors(world.problem(set, budget_ms), {}, {}, {});
  EXPECT_TRUE(selection.summary.unmet.empty());
  EXPECT_GT(selection.chosen.size(), 0U);
  for (std::uint32_t p = 0; p < world.subdivision.cpvs.size(); ++p)
    EXPECT_LE(time_after_ms(world, set, world.subdivision.cpvs[p], selection.assigned[p]), budget_ms) << "CPV " << p;
}

TEST(SelectionInput, WhatIsReachableIsReached) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto world = random_world(seed, 8, 25);
    const auto set = world.generate();
    const auto reach = world.reach();
    const double reachable_ms = *std::max_element(reach.predicted_ms.begin(), reach.predicted_ms.end());
    const auto solved = select_impostors(world.problem(set, reachable_ms * (1.0 + 1e-9)), {.bound_iterations = 20}, {}, {});
    EXPECT_TRUE(solved.summary.unmet.empty()) << "seed " << seed;
    for (std::uint32_t p = 0; p < world.subdivision.cpvs.size(); ++p)
      EXPECT_LE(time_after_ms(world, set, world.subdivision.cpvs[p], solved.assigned[p]), reachable_ms * (1.0 + 1e-9));
    EXPECT_LE(solved.summary.lower_bound_bytes, solved.summary.bytes);
    const auto unsolved = select_impostors(world.problem(set, 0.9 * reachable_ms), {.bound_iterations = 0}, {}, {});
    EXPECT_FALSE(unsolved.summary.unmet.empty()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace standin::test
