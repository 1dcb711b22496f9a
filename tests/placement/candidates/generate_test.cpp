#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "placement/candidates/cell_index.h"
#include "placement/candidates/outlines.h"
#include "tests/placement/candidates/toy_world.h"

namespace standin::test {
namespace {

/// Objects of the node that some CPV of the cells has a term for, found without the index.
std::vector<std::uint32_t> visible_objects(const ToyWorld& world, const Candidate& candidate) {
  std::set<std::uint32_t> result;
  const auto& node = world.hierarchy.nodes[candidate.node];
  for (const auto& cpv : world.subdivision.cpvs) {
    if (!std::binary_search(candidate.cells.begin(), candidate.cells.end(), cpv.cell)) continue;
    for (const auto& term : world.subdivision.terms_of(cpv)) {
      const auto rank = world.hierarchy.rank[term.object];
      if (rank >= node.first && rank < node.first + node.count) result.insert(term.object);
    }
  }
  return {result.begin(), result.end()};
}

Box bounds_of(const ToyWorld& world, const Candidate& candidate) {
  Box bounds;
  for (const auto object : candidate.objects) bounds.extend(world.scene.objects[object].bounds);
  return bounds;
}

void check_candidate(const ToyWorld& world, const Candidate& candidate) {
  EXPECT_EQ(candidate.objects, visible_objects(world, candidate));
  EXPECT_FALSE(candidate.cells.empty());
  EXPECT_TRUE(std::is_sorted(candidate.cells.begin(), candidate.cells.end()));
  for (const auto cell : candidate.cells) EXPECT_TRUE(encloses(candidate.view_cell, world.subdivision.cells[cell].box));
  const auto sketch = sketch_impostor(bounds_of(world, candidate), ObjectOutlines(world.scene).of(candidate.objects), candidate.view_cell,
                                      world.camera, world.quality);
  EXPECT_LE(sketch.layers, world.quality.max_layers);
  EXPECT_GE(candidate.bytes, 4.0);
  EXPECT_GT(candidate.cost.quads, 0.0);
}

void check_tight(const ToyWorld& world, const Candidate& candidate) {
  Shaft narrower = std::get<Shaft>(candidate.view_cell);
  narrower.tan_half.x *= 1.0 - 1e-6;
  Shaft farther = std::get<Shaft>(candidate.view_cell);
  farther.min_distance_m *= 1.0 + 1e-6;
  const auto excludes_one = [&](const Shaft& shaft) {
    return std::any_of(candidate.cells.begin(), candidate.cells.end(),
                       [&](auto cell) { return !encloses(shaft, world.subdivision.cells[cell].box); });
  };
  EXPECT_TRUE(excludes_one(narrower));
  EXPECT_TRUE(excludes_one(farther));
}

TEST(Candidates, HoldWhatTheyPromise) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto world = random_world(seed, 8, 30);
    const auto set = world.generate();
    EXPECT_GT(set.candidates.size(), 10U);
    EXPECT_EQ(set.generated, set.candidates.size() + set.duplicates + set.impossible + set.hopeless);
    std::set<std::pair<std::uint32_t, std::vector<std::uint32_t>>> once;
    std::set<std::pair<std::vector<std::uint32_t>, std::vector<std::uint32_t>>> same_impostor;
    for (const auto& candidate : set.candidates) {
      check_candidate(world, candidate);
      check_tight(world, candidate);
      EXPECT_TRUE(once.insert({candidate.node, candidate.cells}).second);
      EXPECT_TRUE(same_impostor.insert({candidate.objects, candidate.cells}).second) << "parent repeats its child's impostor";
    }
  }
}

TEST(Candidates, BoxesHoldWhatTheyPromise) {
  auto world = ascii_world({"A....0123", "B....4567"}, 10.0);
  world.options.shape = CellShape::kBox;
  const auto set = world.generate();
  std::size_t shared = 0;
  for (const auto& candidate : set.candidates) {
    check_candidate(world, candidate);
    ASSERT_TRUE(std::holds_alternative<Box>(candidate.view_cell));
    if (candidate.cells.size() > 1) ++shared;
  }
  EXPECT_GT(shared, 0U);
}

TEST(Candidates, DoNotDependOnThreads) {
  auto world = random_world(3, 12, 40);
  const auto one = world.generate();
  world.options.threads = 3;
  const auto three = world.generate();
  ASSERT_EQ(one.candidates.size(), three.candidates.size());
  for (std::size_t i = 0; i < one.candidates.size(); ++i) {
    EXPECT_EQ(one.candidates[i].node, three.candidates[i].node);
    EXPECT_EQ(one.candidates[i].cells, three.candidates[i].cells);
    EXPECT_EQ(one.candidates[i].bytes, three.candidates[i].bytes);
    EXPECT_EQ(std::get<Shaft>(one.candidates[i].view_cell).tan_half, std::get<Shaft>(three.candidates[i].view_cell).tan_half);
  }
  EXPECT_EQ(one.duplicates, three.duplicates);
}

TEST(Candidates, NeighboursShareAShaft) {
  // Eight cells in a row straight ahead, 100 m off: some candidate serves them all.
  const auto world = ascii_world({"A.........01234567"}, 10.0);
  const auto set = world.generate();
  const auto serves_all = [](const Candidate& candidate) { return candidate.cells.size() == 8; };
  EXPECT_TRUE(std::any_of(set.candidates.begin(), set.candidates.end(), serves_all));
}

TEST(Candidates, NoneWhereTheClusterReachesIntoTheCell) {
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0), Vec3(10.0)});
  world.finish_objects();
  const auto cell = world.add_cell({0, {0, 0, 0}}, {Vec3(9.0), Vec3(20.0)});
  world.add_cpv(cell, {{0, 100.0}});
  const auto set = world.generate();
  EXPECT_TRUE(set.candidates.empty());
  EXPECT_EQ(set.impossible, 1U);
}

TEST(Candidates, NoneThatCostMoreThanTheySave) {
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0), Vec3(2.0)});
  world.finish_objects();
  const auto cell = world.add_cell({0, {0, 0, 0}}, {Vec3(100.0, 0.0, 0.0), Vec3(110.0, 1.0, 10.0)});
  world.add_cpv(cell, {{0, 0.009}});  // an impostor's draw alone costs 0.01 ms
  const auto set = world.generate();
  EXPECT_TRUE(set.candidates.empty());
  EXPECT_EQ(set.hopeless, 1U);
}

TEST(Candidates, NothingFromNothing) {
  ToyWorld world = empty_toy_world();
  EXPECT_TRUE(world.generate().candidates.empty());
  world.add_object({Vec3(0.0), Vec3(2.0)});
  world.finish_objects();
  world.add_cell({0, {0, 0, 0}}, {Vec3(100.0, 0.0, 0.0), Vec3(110.0, 1.0, 10.0)});
  EXPECT_EQ(world.generate().generated, 0U);
}

TEST(CellIndex, KnowsWhoSeesWhat) {
  ToyWorld world = empty_toy_world();
  for (int i = 0; i < 4; ++i) world.add_object({Vec3(10.0 * i, 0.0, 0.0), Vec3(10.0 * i + 1.0, 1.0, 1.0)});
  world.finish_objects();
  for (int i = 0; i < 3; ++i) world.add_cell({2, {i, 0, 0}}, {Vec3(0.0, 0.0, 50.0 + i), Vec3(1.0, 1.0, 51.0 + i)});
  world.add_cpv(0, {{0, 1.0}, {3, 2.0}});
  world.add_cpv(0, {{1, 4.0}});
  world.add_cpv(2, {{3, 8.0}, {2, 16.0}});
  const CellIndex index(world.hierarchy, world.subdivision);
  EXPECT_EQ(index.visible(0).size(), 3U);
  EXPECT_EQ(index.visible(1).size(), 0U);
  EXPECT_EQ(index.cpvs(0).end - index.cpvs(0).begin, 2U);
  EXPECT_EQ(index.cpvs(1).begin, index.cpvs(1).end);
  EXPECT_EQ(index.cells_seeing(0), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(index.cells_seeing(world.hierarchy.leaf[2]), (std::vector<std::uint32_t>{2}));
  EXPECT_EQ(index.terms_ms(world.subdivision.cpvs[0], 0), 3.0);
  EXPECT_EQ(index.terms_ms(world.subdivision.cpvs[2], 0), 24.0);
  EXPECT_EQ(index.terms_ms(world.subdivision.cpvs[2], world.hierarchy.leaf[2]), 16.0);
  EXPECT_EQ(index.terms_ms(world.subdivision.cpvs[2], world.hierarchy.leaf[0]), 0.0);
}

}  // namespace
}  // namespace standin::test
