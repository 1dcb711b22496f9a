#include "placement/view_space/subdivision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/cell_locator.h"
#include "render/base/error.h"
#include "tests/support/ascii_world.h"
#include "tests/support/same_subdivision.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 515;

struct World {
  Scene scene;
  ViewSpace space;
  ViewSpaceOptions options;
  Camera camera;
  std::vector<std::uint32_t> rank;

  World(const std::vector<std::string>& plan, std::vector<Box> boxes, ViewSpaceOptions given = {})
      : scene(test::ascii_world(plan)),
        space(make_box_view_space(std::move(boxes), given)),
        options(given),
        rank(test::identity_rank(scene)) {}

  [[nodiscard]] Subdivision subdivide_for(double budget_ms, const TimeModel& model, const Visibility& visibility = {},
                                          SubdivisionOptions given = {}, SearchMemory* memory = nullptr) const {
    given.predicted_budget_ms = budget_ms;
    return subdivide(scene, rank, space, visibility, model, camera, options, given, {}, memory);
  }
  [[nodiscard]] RegionEstimator estimator(const TimeModel& model) const { return {scene, rank, model, camera, options}; }
  [[nodiscard]] std::vector<std::uint32_t> all() const { return rank; }
};

// A forest of 9 trees 80 m to the east of a small view space.
World forest_world() {
  return {{".........TTT", ".........TTT", ".........TTT"}, {{{10, 1.6, 13}, {14, 1.8, 17}}}};
}

World small_town(int refine_levels = 1) {
  ViewSpaceOptions options;
  options.leaf_m = 20.0;
  options.refine_levels = refine_levels;
  options.interval_deg = 22.5;
  return {{"#..T#.", "..o...", "T.#.T.", "...o.#"},
          {{{10, 1.6, 0}, {30, 1.8, 10}}, {{0, 1.6, 10}, {60, 1.8, 20}}, {{30, 1.6, 20}, {40, 1.8, 40}}},
          options};
}

using Region = std::pair<CellKey, DirectionInterval>;

std::map<Region, Cpv> regions_of(const Subdivision& subdivision) {
  std::map<Region, Cpv> regions;
  for (const Cpv& cpv : subdivision.cpvs) regions[{subdivision.cells[cpv.cell].key, subdivision.intervals[cpv.interval]}] = cpv;
  return regions;
}

std::vector<DirectionInterval> all_intervals(int level) {
  std::vector<DirectionInterval> intervals;
  for (int face = 0; face < kFaceCount; ++face)
    for (int i = 0; i < 1 << level; ++i)
      for (int j = 0; j < 1 << level; ++j) intervals.push_back({static_cast<Face>(face), level, i, j});
  return intervals;
}

TEST(Subdivision, IsSlowOnlyWhenLookingAtTheForest) {
  const World world = forest_world();
  const TimeModel model = test::triangle_time_model();  // the forest takes 10.8 ms
  const Subdivision found = world.subdivide_for(5.0, model);
  ASSERT_FALSE(found.cpvs.empty());
  const Vec3 to_forest = glm::normalize(Vec3(105, 3, 15) - Vec3(12, 1.7, 15));
  bool ahead = false;
  for (const Cpv& cpv : found.cpvs) {
    const DirectionInterval& interval = found.intervals[cpv.interval];
    ahead = ahead || interval == interval_of(to_forest, interval.level);
    for (const Vec3& corner : interval.corner_directions())  // half image diagonal 30.4, interval 16, forest 11 degrees: 70 is far beyond
      EXPECT_GT(glm::dot(corner, to_forest), std::cos(glm::radians(70.0)));
    EXPECT_GT(cpv.predicted_ms, 5.0);
    EXPECT_LE(cpv.predicted_ms, 10.8 + 0.002 + 1e-9);
    for (const RegionTerm& term : found.terms_of(cpv))
      EXPECT_NEAR(term.predicted_ms, world.scene.objects[term.object].name == "tree" ? 1.2 : 0.002, 1e-12);
  }
  EXPECT_TRUE(ahead);
  EXPECT_NEAR(found.worst_predicted_ms, 10.802, 1e-9);
}

TEST(Subdivision, NothingIsSlowWithinAGenerousBudgetAndTheWorstRegionIsStillKnown) {
  const Subdivision found = forest_world().subdivide_for(11.0, test::triangle_time_model());
  EXPECT_TRUE(found.cpvs.empty());
  EXPECT_TRUE(found.intervals.empty());
  EXPECT_EQ(found.cells.size(), 1U);
  EXPECT_NEAR(found.worst_predicted_ms, 10.802, 1e-9);
  EXPECT_EQ(found.cells[0].worst_interval.face, Face::kPosX);
}

// In whatever order the budgets come: what was searched for a tighter one serves, and for a looser one is searched anew.
TEST(Subdivision, MemoryOfOtherBudgetsChangesNothing) {
  const World world = small_town(2);
  const TimeModel model = test::full_time_model();
  const double worst = world.subdivide_for(1e9, model).worst_predicted_ms;
  SearchMemory memory;
  std::set<std::size_t> cpvs;
  for (const double share : {0.8, 0.5, 0.9, 0.65, 0.5, 0.3, 1.1}) {
    const Subdivision fresh = world.subdivide_for(share * worst, model);
    cpvs.insert(fresh.cpvs.size());
    test::expect_same(world.subdivide_for(share * worst, model, {}, {}, &memory), fresh);
  }
  EXPECT_GE(cpvs.size(), 5U);
}

TEST(SearchMemory, RecallsTheLastSearchOfACell) {
  SearchMemory memory;
  const CellKey cell{3, {1, 2, 3}};
  EXPECT_EQ(memory.recall({cell, 6.0}), nullptr);
  memory.keep({cell, 6.0}, {});
  memory.keep({cell, 5.0}, {});
  EXPECT_EQ(memory.recall({cell, 7.0})->predicted_budget_ms, 5.0);
  EXPECT_EQ(memory.recall({{3, {1, 2, 4}}, 5.0}), nullptr);
}

TEST(DirectionSearch, ALooserBudgetKeepsWhatExceedsIt) {
  DirectionSearchResult found;
  found.add({{Face::kPosX, 2, 0, 0}, false, 1.0, 7.0}, std::vector<RegionTerm>{{4, 6.0}});
  found.add({{Face::kPosX, 2, 1, 0}, true, 2.0, 9.0}, std::vector<RegionTerm>{{5, 3.0}, {6, 4.0}});
  found.worst_predicted_ms = 9.0;
  EXPECT_EQ(at_looser_budget(found, 6.0).hot.size(), 2U);
  const auto looser = at_looser_budget(found, 7.0);  // a bound of just the budget is within it
  ASSERT_EQ(looser.hot.size(), 1U);
  EXPECT_EQ(looser.hot[0].predicted_ms, 9.0);
  EXPECT_TRUE(looser.hot[0].pixels_capped);
  ASSERT_EQ(looser.terms.size(), 2U);
  EXPECT_EQ(looser.terms_of(looser.hot[0])[1].object, 6U);
  EXPECT_EQ(looser.worst_predicted_ms, 9.0);
  EXPECT_TRUE(at_looser_budget(found, 9.0).hot.empty());
}

// The search against a plain evaluation of every leaf region from scratch.
TEST(Subdivision, FindsExactlyTheRegionsOverBudget) {
  const World world = small_town();
  for (const TimeModel& model : {test::triangle_time_model(), test::full_time_model()}) {
    const RegionEstimator estimator = world.estimator(model);
    const CellBoxes cells(world.space);
    const double worst = world.subdivide_for(1e9, model).worst_predicted_ms;
    const Subdivision found = world.subdivide_for(0.7 * worst, model);
    const auto regions = regions_of(found);
    std::size_t hot = 0;
    double highest = 0.0;
    for (const Cell& cell : found.cells) {
      CellCosts costs = estimator.cell_costs(cells.chain(cell.key), world.all());
      for (const DirectionInterval& interval : all_intervals(estimator.leaf_level(costs))) {
        const RegionBound bound = estimator.region_bound(costs, interval);
        highest = std::max(highest, bound.predicted_ms);
        const auto at = regions.find({cell.key, interval});
        ASSERT_EQ(at != regions.end(), bound.predicted_ms > 0.7 * worst);
        if (at == regions.end()) continue;
        ++hot;
        EXPECT_EQ(at->second.predicted_ms, bound.predicted_ms);
        EXPECT_EQ(at->second.pixels_capped, bound.pixels_capped);
        const auto terms = found.terms_of(at->second);
        ASSERT_EQ(terms.size(), bound.terms.size());
        double sum = at->second.constant_ms;
        for (std::size_t i = 0; i < terms.size(); ++i) {
          EXPECT_EQ(terms[i].object, bound.terms[i].object);
          EXPECT_GT(terms[i].predicted_ms, 0.0);
          sum += terms[i].predicted_ms;
        }
        EXPECT_EQ(sum, at->second.predicted_ms);
      }
    }
    EXPECT_EQ(hot, found.cpvs.size());
    EXPECT_GT(hot, 0U);
    EXPECT_EQ(highest, found.worst_predicted_ms);
  }
}

/// What is left of a region's bound once some objects are replaced bounds the frame without them, in both linear forms and however stages
/// combine.
void expect_bound_of_subsets(TimeModel model, const FeatureTable& features, const View& view, const Subdivision& found, const Cpv& cpv,
                             Rng& rng) {
  std::vector<std::uint32_t> kept;
  double bound_ms = cpv.constant_ms;
  for (const RegionTerm& term : found.terms_of(cpv)) {
    if (rng.uniform() < 0.5) continue;
    kept.push_back(term.object);
    bound_ms += term.predicted_ms;
  }
  for (const Combination combination : {Combination::kSum, Combination::kMax}) {
    model.combination = combination;
    ASSERT_LE(model.predicted_ms(features.frame(kept, view)), bound_ms * (1 + 1e-12));
  }
}

TEST(Subdivision, BoundsHoldForEverySampledView) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const World world = small_town();
  for (const TimeModel& model : {test::triangle_time_model(), test::full_time_model()}) {
    const Subdivision found = world.subdivide_for(-1.0, model);  // every leaf region is a CPV
    const auto regions = regions_of(found);
    std::vector<CellKey> keys;
    std::vector<Box> boxes;
    for (const Cell& cell : found.cells) {
      keys.push_back(cell.key);
      boxes.push_back(cell.box);
    }
    const CellLocator locator(world.space.grid(), keys, boxes);
    const FeatureTable features(world.scene, world.camera);
    Rng rng(kSeed);
    double tightest = 0.0;
    for (int i = 0; i < 4000; ++i) {
      View view{world.space.sample_position(rng), {rng.uniform(-1, 1), rng.uniform(-0.5, 0.5), rng.uniform(-1, 1)}};
      view.direction = glm::normalize(view.direction);
      const auto cell = locator.find(view.position);
      ASSERT_TRUE(cell.has_value());
      const Cpv& cpv =
          regions.at({keys[*cell], interval_of(view.direction, direction_level(2, keys[*cell].level - world.space.leaf_level))});
      const double predicted_ms = model.predicted_ms(features.frame(world.all(), view));
      ASSERT_LE(predicted_ms, cpv.predicted_ms * (1 + 1e-12)) << "view " << i;
      tightest = std::max(tightest, predicted_ms / cpv.predicted_ms);
      if (i % 8 == 0) expect_bound_of_subsets(model, features, view, found, cpv, rng);
    }
    EXPECT_GT(tightest, 0.5);  // the test could fail: some view comes near its bound
  }
}

TEST(Subdivision, NoChildIsBoundedAboveItsParent) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  const World world = small_town(2);
  const TimeModel model = test::full_time_model();
  const RegionEstimator estimator = world.estimator(model);
  const CellBoxes cells(world.space);
  Rng rng(kSeed);
  int compared = 0;
  for (int i = 0; i < 600; ++i) {
    CellKey key = cells.leaves()[rng.below(cells.leaves().size())];
    key = key.child(static_cast<int>(rng.below(8)));
    const CellKey child = key.child(static_cast<int>(rng.below(8)));
    if (cells.cell_box(child).empty()) continue;
    DirectionInterval interval{static_cast<Face>(rng.below(6)), 2, static_cast<int>(rng.below(4)), static_cast<int>(rng.below(4))};
    CellCosts parent_costs = estimator.cell_costs(cells.chain(key), world.all());
    CellCosts costs = estimator.cell_costs(cells.chain(child), world.all());
    const double parent_ms = estimator.coarse_bound_ms(parent_costs, interval.parent());
    const double halved_cell_ms = estimator.coarse_bound_ms(costs, interval.parent());
    const double child_ms = estimator.region_bound(costs, interval).predicted_ms;
    EXPECT_LE(child_ms, estimator.region_bound(parent_costs, interval).predicted_ms);
    EXPECT_LE(halved_cell_ms, parent_ms);
    EXPECT_LE(child_ms, halved_cell_ms);
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

TEST(Subdivision, BoundsByObjectCountAllOfAnObjectThatMayBeSeen) {
  World world = small_town(0);
  const TimeModel model = test::full_time_model();
  const Subdivision by_sample = world.subdivide_for(0.0, model);
  world.options.bounds = RegionBounds::kByObject;
  const Subdivision by_object = world.subdivide_for(0.0, model);
  const RegionEstimator estimator(world.scene, world.rank, model, world.camera, world.options);
  const CellBoxes cells(world.space);
  const auto sharper = regions_of(by_sample);
  int looser = 0;
  for (const auto& [region, cpv] : regions_of(by_object)) {
    CellCosts costs = estimator.cell_costs(cells.chain(region.first), world.all());
    EXPECT_EQ(cpv.predicted_ms, estimator.coarse_bound_ms(costs, region.second));
    EXPECT_EQ(cpv.predicted_ms, estimator.region_bound(costs, region.second).predicted_ms);
    const auto found = sharper.find(region);
    if (found == sharper.end()) continue;
    EXPECT_LE(found->second.predicted_ms, cpv.predicted_ms);
    looser += found->second.predicted_ms < cpv.predicted_ms ? 1 : 0;
  }
  EXPECT_GT(looser, 0);
}

TEST(Subdivision, HotCellsAreHalvedAndColdOnesKept) {
  const World world = small_town(2);
  const TimeModel model = test::triangle_time_model();
  const double worst = world.subdivide_for(1e9, model).worst_predicted_ms;
  const Subdivision found = world.subdivide_for(0.8 * worst, model);
  const RegionEstimator estimator = world.estimator(model);
  const CellBoxes cells(world.space);
  std::set<std::uint32_t> hot;
  for (const Cpv& cpv : found.cpvs) hot.insert(cpv.cell);
  std::set<int> levels;
  for (std::uint32_t cell = 0; cell < found.cells.size(); ++cell) {
    levels.insert(found.cells[cell].key.level);
    if (hot.contains(cell) && found.cells[cell].key.level < world.space.finest_level) {  // halving did not pay any more
      CellCosts parent = estimator.cell_costs(cells.chain(found.cells[cell].key.parent()), world.all());
      double parent_ms = 0.0;
      for (const DirectionInterval& interval : all_intervals(estimator.leaf_level(parent)))
        parent_ms = std::max(parent_ms, estimator.region_bound(parent, interval).predicted_ms);
      EXPECT_GT(found.cells[cell].worst_predicted_ms, 0.97 * parent_ms);
    }
    EXPECT_EQ(found.cells[cell].box, world.space.cell_box(found.cells[cell].key));
    EXPECT_TRUE(cell == 0 || found.cells[cell - 1].key < found.cells[cell].key);
  }
  EXPECT_GE(levels.size(), 2U);
  EXPECT_TRUE(found.left_out.empty());
}

TEST(Subdivision, HalvingStopsAtEitherLimitAndSaysSo) {
  const World world = small_town(2);
  SubdivisionOptions few_terms, few_cpvs;
  few_terms.max_terms = 1;
  few_cpvs.max_cpvs = 1;
  for (const SubdivisionOptions& options : {few_terms, few_cpvs}) {
    const Subdivision found = world.subdivide_for(0.0, test::triangle_time_model(), {}, options);
    for (const Cell& cell : found.cells) EXPECT_EQ(cell.key.level, world.space.leaf_level);
    EXPECT_THAT(found.left_out, testing::ElementsAre(testing::HasSubstr("more hot cells in position: more than ")));
  }
}

TEST(Subdivision, TheSameForAnyNumberOfThreads) {
  const World world = small_town(2);
  const TimeModel model = test::full_time_model();
  const double budget_ms = 0.6 * world.subdivide_for(1e9, model).worst_predicted_ms;
  SubdivisionOptions options;
  const Subdivision one = world.subdivide_for(budget_ms, model, {}, options);
  options.threads = 3;
  const Subdivision three = world.subdivide_for(budget_ms, model, {}, options);
  test::expect_same(one, three);
}

TEST(Subdivision, VisibilityOnlyRemovesProblemViews) {
  const World world = small_town(0);
  const TimeModel model = test::triangle_time_model();
  const double budget_ms = 0.5 * world.subdivide_for(1e9, model).worst_predicted_ms;
  Visibility visibility{leaf_keys(world.space), {}};
  Rng rng(kSeed);
  for (std::size_t i = 0; i < visibility.cells.size(); ++i) {
    visibility.sets.emplace_back();
    for (std::uint32_t object = 0; object < world.scene.objects.size(); ++object)
      if (rng.below(3) > 0) visibility.sets.back().push_back(object);
  }
  const Subdivision all = world.subdivide_for(budget_ms, model), seen = world.subdivide_for(budget_ms, model, visibility);
  const auto all_regions = regions_of(all), seen_regions = regions_of(seen);
  EXPECT_LT(seen_regions.size(), all_regions.size());
  EXPECT_GT(seen_regions.size(), 0U);
  for (const auto& [region, cpv] : seen_regions) {
    ASSERT_TRUE(all_regions.contains(region));
    EXPECT_LE(cpv.predicted_ms, all_regions.at(region).predicted_ms);
    const auto& set = seen.visible_sets[static_cast<std::size_t>(seen.cells[cpv.cell].visible_set)];
    for (const RegionTerm& term : seen.terms_of(cpv)) EXPECT_TRUE(std::binary_search(set.begin(), set.end(), term.object));
  }
}

TEST(Subdivision, FinerCellsInheritTheVisibleSetOfTheirLeaf) {
  const World world = small_town(1);
  Visibility visibility{leaf_keys(world.space), {}};
  for (std::uint32_t i = 0; i < visibility.cells.size(); ++i) visibility.sets.push_back({0, 1 + i % 5});
  const Subdivision found = world.subdivide_for(0.0, test::triangle_time_model(), visibility);
  for (const Cell& cell : found.cells) {
    const CellKey leaf = cell.key.level == world.space.leaf_level ? cell.key : cell.key.parent();
    EXPECT_EQ(visibility.cells[static_cast<std::size_t>(cell.visible_set)], leaf);
  }
}

TEST(Subdivision, TheSmallerLinearFormIsChosen) {
  const World world = small_town(0);
  const TimeModel model = test::full_time_model();
  const RegionEstimator estimator = world.estimator(model);
  const CellBoxes cells(world.space);
  const Subdivision found = world.subdivide_for(-1.0, model);
  const double most_pixel_ms = model.most_pixel_ms(estimator.features().pixel_terms(), estimator.features().most_passed_pixels());
  std::size_t capped = 0;
  for (const Cpv& cpv : found.cpvs) {
    CellCosts costs = estimator.cell_costs(cells.chain(found.cells[cpv.cell].key), world.all());
    std::vector<std::uint32_t> seen;  // a draw costs something: every seen object has a term
    for (const RegionTerm& term : found.terms_of(cpv))
      seen.push_back(
          static_cast<std::uint32_t>(std::ranges::find(costs.objects, term.object, &ObjectCost::object) - costs.objects.begin()));
    std::vector<Cost> costs_in;
    for (const std::uint32_t i : seen) costs_in.push_back(costs.objects[i].cost);
    const DirectionInterval& interval = found.intervals[cpv.interval];
    for (const DirectionInterval& node : {interval.parent(), interval}) ASSERT_TRUE(estimator.sharpen(costs, node, seen, costs_in, -1.0));
    RegionSums sums = estimator.empty_frame();
    for (const Cost& cost : costs_in) sums.add(cost);
    EXPECT_EQ(cpv.pixels_capped, sums.capped_ms < sums.with_pixels_ms);
    EXPECT_EQ(cpv.predicted_ms, std::min(sums.capped_ms, sums.with_pixels_ms));
    EXPECT_NEAR(cpv.constant_ms, model.milliseconds_per_unit[0] + (cpv.pixels_capped ? most_pixel_ms : 0.0), 1e-12);
    capped += cpv.pixels_capped ? 1 : 0;
  }
  EXPECT_GT(capped, 0U);
  EXPECT_LT(capped, found.cpvs.size());
}

TEST(Subdivision, StopsWhenAskedAndRefusesAForeignVisibility) {
  const World world = small_town();
  const std::atomic<bool> stop{true};
  const auto word = [&](const Visibility& visibility, const WorkBudget& budget) {
    try {
      (void)subdivide(world.scene, world.rank, world.space, visibility, test::triangle_time_model(), world.camera, world.options, {},
                      budget);
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kBadUsage;
  };
  EXPECT_EQ(word({}, WorkBudget(&stop)), ErrorWord::kCancelled);
  EXPECT_EQ(word({{{0, {0, 0, 0}}}, {{0}}}, {}), ErrorWord::kInternal);
}

TEST(Subdivision, AViewSpaceOfOnePointWorks) {
  World world = forest_world();
  world.space = make_path_view_space({{12, 1.7, 15}}, 0.0, {});
  const Subdivision found = world.subdivide_for(5.0, test::triangle_time_model());
  EXPECT_EQ(found.cells.size(), 1U);
  EXPECT_FALSE(found.cpvs.empty());
}

}  // namespace
}  // namespace standin
