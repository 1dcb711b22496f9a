#include "placement/view_space/region_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/region_bound.h"
#include "placement/view_space/region_sample.h"
#include "tests/support/ascii_world.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 11;
const std::vector<Box> kParts = {{{0, 0, 0}, {4, 1, 1}}, {{3, 0, 1}, {4, 1, 4}}};
constexpr DirectionInterval kInterval{Face::kPosX, 2, 1, 2};

bool lies_in_region(const View& view) {
  const bool inside = std::ranges::any_of(kParts, [&](const Box& part) { return part.contains(view.position); });
  return inside && interval_of(view.direction, kInterval.level) == kInterval;
}

TEST(RegionViews, LieInTheirRegionHoweverFarTheyStep) {
  RegionViews region(kParts, kInterval, Rng(kSeed));
  RegionPoint at = region.draw();
  for (int i = 0; i < 2000; ++i) {
    EXPECT_TRUE(lies_in_region(region.view(region.draw())));
    at = region.draw_near(at, 1.0);
    ASSERT_TRUE(lies_in_region(region.view(at))) << i;
  }
}

TEST(RegionViews, AStepIsNoLongerThanItsShareOfTheRegion) {
  RegionViews region(kParts, kInterval, Rng(kSeed));
  double longest = 0.0;
  for (int i = 0; i < 500; ++i) {
    const RegionPoint from = region.draw(), to = region.draw_near(from, 0.1);
    const Vec3 step = glm::abs(to.position - from.position);
    EXPECT_LE(step.x, 0.4 + 1e-12);
    EXPECT_LE(step.y, 0.1 + 1e-12);
    longest = std::max(longest, step.x);
  }
  EXPECT_GT(longest, 0.3);
}

// A hill whose top is a corner of the L-shaped cell and of the interval.
TEST(RegionViews, AClimbComesNearerToTheWorstThanUniformViews) {
  const auto [a0, a1, b0, b1] = kInterval.angles_rad();
  const Vec3 top = direction_at(kInterval.face, a1, b1);
  const auto height = [&](const View& view) { return view.position.z + 4.0 * glm::dot(view.direction, top); };
  double climbed = 0.0, uniform = 0.0;
  std::uint32_t views = 0;
  climb_to_worst({kParts, kInterval, Rng(kSeed)}, 96, [&](const View& view) {
    ++views;
    climbed = std::max(climbed, height(view));
    return height(view);
  });
  RegionViews region(kParts, kInterval, Rng(kSeed));
  for (int i = 0; i < 96; ++i) uniform = std::max(uniform, height(region.view(region.draw())));
  EXPECT_EQ(views, 96U);
  EXPECT_GT(climbed, 8.0 - 0.02);
  EXPECT_GT(climbed, uniform);
}

// Sampled regions lie between what fresh views need and the bound.
TEST(RegionSample, DemandIsThatOfTheWorstViewsWithAMarginAndBelowTheBoundWithOne) {
  const Scene scene = test::ascii_world({"#..T#.", "..o...", "T.#.T.", "...o.#"});
  const std::vector<std::uint32_t> rank = test::identity_rank(scene);
  ViewSpaceOptions options{.leaf_m = 20.0, .refine_levels = 1, .interval_deg = 22.5};
  const ViewSpace space = make_box_view_space({{{10, 1.6, 0}, {30, 1.8, 10}}, {{0, 1.6, 10}, {60, 1.8, 20}}}, options);
  const CellBoxes cells(space);
  const TimeModel model = test::full_time_model();
  const Camera camera;
  const RegionEstimator by_sample(scene, rank, model, camera, options);
  options.bounds = RegionBounds::kByView;
  const RegionEstimator by_view(scene, rank, model, camera, options);
  int below = 0;
  for (const CellKey& key : cells.leaves()) {
    CellCosts certified = by_sample.cell_costs(cells.chain(key), rank),
              sampled = by_view.cell_costs(cells.chain(key), rank, cells.parts(key));
    for (int i = 0; i < 4; ++i) {
      const DirectionInterval interval{Face::kPosX, 2, i, 2};
      const RegionBound bound = by_sample.region_bound(certified, interval), demand = by_view.region_bound(sampled, interval);
      EXPECT_LE(demand.predicted_ms, (1.0 + kSampledMargin) * bound.predicted_ms);
      below += demand.predicted_ms < 0.999 * bound.predicted_ms ? 1 : 0;
      double fresh_ms = 0.0;
      RegionViews region(cells.parts(key), interval, Rng(kSeed));
      for (int v = 0; v < 100; ++v)
        fresh_ms = std::max(fresh_ms, model.predicted_ms(by_view.features().frame(rank, region.view(region.draw()))));
      // Few views miss much in a cell of 20 m with a tree in it: no promise.
      EXPECT_GE(demand.predicted_ms, 0.5 * std::min(bound.predicted_ms, (1.0 + kSampledMargin) * fresh_ms));
      EXPECT_EQ(demand.predicted_ms, by_view.region_bound(sampled, interval).predicted_ms);
    }
  }
  EXPECT_GT(below, 0);
}

}  // namespace
}  // namespace standin
