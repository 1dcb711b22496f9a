#include <gtest/gtest.h>

#include <algorithm>

#include "tests/placement/candidates/toy_world.h"

namespace standin::test {
namespace {

/// Gain of each node's single-cell candidate in a CPV, from generate_candidates and the hierarchy alone; 0 where there is none.
std::vector<double> own_gains(const ToyWorld& world, const CandidateSet& set, const Cpv& cpv) {
  std::vector<double> gains(world.hierarchy.nodes.size(), 0.0);
  for (const auto& candidate : set.candidates) {
    if (candidate.cells != std::vector<std::uint32_t>{cpv.cell}) continue;
    const Cost cost = world.model.cost(impostor_features_bound(candidate.cost, world.camera));
    double gain_ms = -(cpv.pixels_capped ? cost.fixed_ms : cost.fixed_ms + cost.pixel_ms);
    for (const auto& term : world.subdivision.terms_of(cpv))
      if (std::binary_search(candidate.objects.begin(), candidate.objects.end(), term.object)) gain_ms += term.predicted_ms;
    gains[candidate.node] = gain_ms;
  }
  return gains;
}

bool overlap(const HierarchyNode& a, const HierarchyNode& b) {
  return a.first < b.first + b.count && b.first < a.first + a.count;
}

/// Best sum over all sets of disjoint nodes, by trying them all.
double best_of_all(const ToyWorld& world, const std::vector<double>& gains) {
  double best = 0.0;
  for (std::uint32_t mask = 0; mask < (1U << gains.size()); ++mask) {
    double sum = 0.0;
    bool disjoint = true;
    for (std::size_t a = 0; a < gains.size() && disjoint; ++a) {
      if ((mask >> a & 1U) == 0) continue;
      sum += gains[a];
      for (std::size_t b = 0; b < a; ++b)
        if ((mask >> b & 1U) != 0 && overlap(world.hierarchy.nodes[a], world.hierarchy.nodes[b])) disjoint = false;
    }
    if (disjoint) best = std::max(best, sum);
  }
  return best;
}

TEST(Reach, EqualsTheBestDisjointSet) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto world = random_world(seed, 6, 8);
    const auto set = world.generate();
    const auto reach = world.reach();
    for (std::size_t p = 0; p < world.subdivision.cpvs.size(); ++p) {
      const Cpv& cpv = world.subdivision.cpvs[p];
      EXPECT_LE(reach.predicted_ms[p], cpv.predicted_ms);
      EXPECT_NEAR(reach.predicted_ms[p], cpv.predicted_ms - best_of_all(world, own_gains(world, set, cpv)), 1e-9)
          << "seed " << seed << ", CPV " << p;
    }
  }
}

TEST(Reach, NamesWhatCannotBeReplaced) {
  // Object 0 reaches into the cell; object 1 is far and cheap to replace.
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0), Vec3(10.0)});
  world.add_object({Vec3(100.0, 0.0, 0.0), Vec3(103.0, 2.0, 3.0)});
  world.finish_objects();
  const auto cell = world.add_cell({0, {0, 0, 0}}, {Vec3(5.0), Vec3(8.0)});
  world.add_cpv(cell, {{0, 30.0}, {1, 50.0}}, 1.0);
  const auto reach = world.reach();
  EXPECT_EQ(reach.blockers[0], (std::vector<std::uint32_t>{0}));
  EXPECT_GT(reach.predicted_ms[0], 31.0);
  EXPECT_LT(reach.predicted_ms[0], 36.0);
}

TEST(Reach, AtMostFiveBlockersLargestFirst) {
  ToyWorld world = empty_toy_world();
  for (int i = 0; i < 8; ++i) world.add_object({Vec3(0.0), Vec3(10.0 + i)});
  world.finish_objects();
  const auto cell = world.add_cell({0, {0, 0, 0}}, {Vec3(5.0), Vec3(8.0)});
  std::vector<RegionTerm> terms;
  for (std::uint32_t i = 0; i < 8; ++i) terms.push_back({i, 1.0 + i});
  world.add_cpv(cell, terms);
  const auto reach = world.reach();
  EXPECT_EQ(reach.blockers[0], (std::vector<std::uint32_t>{7, 6, 5, 4, 3}));
  EXPECT_DOUBLE_EQ(reach.predicted_ms[0], world.subdivision.cpvs[0].predicted_ms);
}

TEST(Reach, DoesNotDependOnThreads) {
  auto world = random_world(11, 12, 30);
  const auto one = world.reach();
  world.options.threads = 3;
  const auto three = world.reach();
  EXPECT_EQ(one.predicted_ms, three.predicted_ms);
  EXPECT_EQ(one.blockers, three.blockers);
}

}  // namespace
}  // namespace standin::test
