#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

TEST(Candidates, PyramidsAreThoseOfTheGridAndNotTightened) {
  std::size_t loose = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto world = random_world(seed, 8, 30);
    world.options.shape = CellShape::kPyramid;
    const auto set = world.generate();
    EXPECT_GT(set.candidates.size(), 10U);
    EXPECT_EQ(set.generated, set.candidates.size() + set.duplicates + set.impossible + set.hopeless);
    for (const auto& candidate : set.candidates) {
      check_candidate(world, candidate);
      const Box& bounds = world.hierarchy.nodes[candidate.node].bounds;
      const auto& shaft = std::get<Shaft>(candidate.view_cell);
      const double apex_deg = glm::degrees(2.0 * std::atan(shaft.tan_half.x));
      EXPECT_TRUE(std::ranges::any_of(world.options.apex_deg, [&](double known) { return std::abs(known - apex_deg) < 1e-9; }));
      EXPECT_EQ(shaft.tan_half.x, shaft.tan_half.y);
      EXPECT_EQ(shaft.apex, bounds.centre());
      const double doublings = std::log2(shaft.min_distance_m / bounds.diagonal());
      EXPECT_NEAR(doublings, std::round(doublings), 1e-9);
      EXPECT_GE(doublings, -1e-9);
      EXPECT_LE(doublings, 10.0 + 1e-9);
      Shaft farther = shaft;
      farther.min_distance_m *= 1.01;
      loose += std::ranges::all_of(candidate.cells, [&](auto cell) { return encloses(farther, world.subdivision.cells[cell].box); });
    }
  }
  EXPECT_GT(loose, 0U);
}

TEST(Candidates, OfOneCellServeNoOtherLeaf) {
  ToyWorld world = empty_toy_world();
  world.add_object({Vec3(0.0), Vec3(4.0)});
  world.finish_objects();
  for (int i = 0; i < 4; ++i) {  // a leaf halved once, another one beside it
    const CellKey key = i < 3 ? CellKey{4, {i / 2, 0, i % 2}} : CellKey{3, {1, 0, 0}};
    const Vec3 low(5.0 * key.index[0] * (i < 3 ? 1.0 : 2.0), 0.0, 100.0 + 5.0 * key.index[2]);
    const auto cell = world.add_cell(key, {low, low + Vec3(i < 3 ? 5.0 : 10.0, 1.0, 5.0)});
    world.add_cpv(cell, {{0, 10.0}});
  }
  const auto sets_of = [&](CellShape shape) {
    world.options.shape = shape;
    std::set<std::vector<std::uint32_t>> sets;
    for (const auto& candidate : world.generate().candidates) {
      EXPECT_TRUE(std::holds_alternative<Box>(candidate.view_cell));
      sets.insert(candidate.cells);
    }
    return sets;
  };
  const std::set<std::vector<std::uint32_t>> alone = {{0}, {1}, {2}, {3}, {0, 1, 2}};
  EXPECT_EQ(sets_of(CellShape::kCell), alone);
  auto together = alone;
  together.insert({0, 1, 2, 3});
  EXPECT_EQ(sets_of(CellShape::kBox), together);
}

/// Every technique, or those named.
SizeModels offering(std::initializer_list<Technique> techniques) {
  SizeModels sizes;
  for (const Technique technique : techniques) sizes.offer(technique, default_size_model(technique));
  return sizes;
}
constexpr auto kAllTechniques = {Technique::kLayered, Technique::kDepthMesh, Technique::kPlanar, Technique::kLodSprite};

bool one_layer(const ToyWorld& world, const Candidate& candidate) {
  BakeQuality planar = world.quality;
  planar.max_layers = 1;
  return plan_impostor(bounds_of(world, candidate), ObjectOutlines(world.scene).of(candidate.objects), candidate.view_cell, world.camera,
                       planar)
      .possible;
}

using Place = std::pair<std::uint32_t, std::vector<std::uint32_t>>;  // node, cells

TEST(Candidates, AreOfferedOncePerTechnique) {
  std::array<std::size_t, kTechniqueCount> count{};
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto world = random_world(seed, 8, 30);
    world.sizes = offering(kAllTechniques);
    const auto set = world.generate();
    EXPECT_EQ(set.generated, set.candidates.size() + set.duplicates + set.impossible + set.hopeless);
    std::set<std::pair<Technique, Place>> once;
    std::set<Place> layered;
    for (const auto& candidate : set.candidates)
      if (candidate.technique == Technique::kLayered) layered.insert({candidate.node, candidate.cells});
    for (const auto& candidate : set.candidates) {
      ++count.at(static_cast<std::size_t>(candidate.technique));
      check_candidate(world, candidate);
      EXPECT_TRUE(once.insert({candidate.technique, {candidate.node, candidate.cells}}).second);
      // Where layers are offered, one layer is the layered impostor's: a planar one is for cells that nothing else serves together.
      if (candidate.technique != Technique::kPlanar) continue;
      EXPECT_TRUE(one_layer(world, candidate));
      EXPECT_FALSE(layered.contains({candidate.node, candidate.cells}));
    }
  }
  for (std::size_t t = 0; t < kTechniqueCount; ++t) EXPECT_GT(count.at(t), 0U) << technique_names()[t];
}

TEST(Candidates, OfLayersAreTheSameWhateverElseIsOffered) {
  auto world = random_world(4, 8, 30);
  const auto alone = world.generate();
  world.sizes = offering(kAllTechniques);
  std::vector<Candidate> layered = world.generate().candidates;
  std::erase_if(layered, [](const Candidate& candidate) { return candidate.technique != Technique::kLayered; });
  std::set<Place> places;
  for (const auto& candidate : layered) places.insert({candidate.node, candidate.cells});
  for (const auto& candidate : alone.candidates) EXPECT_TRUE(places.contains({candidate.node, candidate.cells}));
}

TEST(Candidates, OfOneTechniqueAreOfThatAlone) {
  for (const Technique technique : kAllTechniques) {
    auto world = random_world(2, 8, 30);
    world.sizes = offering({technique});
    const auto set = world.generate();
    EXPECT_GT(set.candidates.size(), 0U) << technique_name(technique);
    EXPECT_EQ(set.generated, set.candidates.size() + set.duplicates + set.impossible + set.hopeless);
    for (const auto& candidate : set.candidates) {
      EXPECT_EQ(candidate.technique, technique);
      EXPECT_TRUE(technique != Technique::kPlanar || one_layer(world, candidate));
    }
    EXPECT_EQ(world.reach().predicted_ms.size(), world.subdivision.cpvs.size());
  }
}

// A row of cells before a deep row of walls: together they need layers, in parts a plane each.
TEST(Candidates, PlanarOnesServePartsOfWhatNeedsLayers) {
  ToyWorld world = empty_toy_world();
  for (int i = 0; i < 3; ++i) world.add_object({Vec3(-3.0, 0.0, -4.0 * i), Vec3(3.0, 3.0, -4.0 * i + 1.0)});
  world.finish_objects();
  for (int i = 0; i < 8; ++i) {
    const Vec3 low(30.0 * i - 120.0, 1.7, 400.0);
    const auto cell = world.add_cell({6, {i, 0, 0}}, {low, low + Vec3(30.0, 0.1, 10.0)});
    world.add_cpv(cell, {{0, 4.0}, {1, 4.0}, {2, 4.0}});
  }
  world.sizes = offering({Technique::kLayered, Technique::kPlanar});
  const auto set = world.generate();
  const auto layers_are_needed = [&](const Candidate& candidate) { return candidate.cells.size() == 8 && !one_layer(world, candidate); };
  EXPECT_TRUE(std::any_of(set.candidates.begin(), set.candidates.end(), layers_are_needed));
  std::set<std::uint32_t> served;
  for (const auto& candidate : set.candidates)
    if (candidate.technique == Technique::kPlanar && candidate.cells.size() > 1)
      served.insert(candidate.cells.begin(), candidate.cells.end());
  EXPECT_GE(served.size(), 4U);
}

TEST(Candidates, MaskedSurfacesAreNotOfferedAsLodSprites) {
  auto world = random_world(2, 8, 30);
  world.sizes = offering(kAllTechniques);
  Material leaves;
  leaves.alpha_mode = AlphaMode::kMask;
  world.scene.materials.push_back(leaves);
  world.scene.meshes.emplace_back();  // without vertices: bounds are looked at
  world.scene.parts.push_back({});
  for (Object& object : world.scene.objects) object.part_count = 1;
  for (const auto& candidate : world.generate().candidates) EXPECT_NE(candidate.technique, Technique::kLodSprite);
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
