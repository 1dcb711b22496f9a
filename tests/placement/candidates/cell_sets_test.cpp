#include "placement/candidates/cell_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "tests/placement/candidates/toy_world.h"

namespace standin::test {
namespace {

constexpr double kDeg = 0.017453292519943295;

TEST(DirectionGrid, FindsEveryDirectionWithinTheAngle) {
  const DirectionGrid grid(11.25);
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Rng rng(seed);
    Vec3 unit = glm::normalize(Vec3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)));
    if (seed % 10 == 0) unit = Vec3(0.0, seed % 20 == 0 ? 1.0 : -1.0, 0.0);
    const double angle = rng.uniform(0.05, 1.2);
    std::vector<std::uint32_t> found;
    grid.append_near(unit, angle, found);
    const std::set<std::uint32_t> once(found.begin(), found.end());
    EXPECT_EQ(once.size(), found.size()) << "seed " << seed;
    for (std::uint32_t d = 0; d < grid.size(); ++d) {
      if (glm::dot(grid.frame(d).axis, unit) < std::cos(angle)) continue;
      // All azimuths of a pole are the same direction; one of them is enough.
      const bool pole = std::abs(grid.frame(d).axis.y) > 1.0 - 1e-12;
      const bool there = pole ? std::any_of(once.begin(), once.end(),
                                            [&](auto other) { return glm::dot(grid.frame(other).axis, grid.frame(d).axis) > 1.0 - 1e-9; })
                              : once.count(d) == 1;
      EXPECT_TRUE(there) << "seed " << seed << ", direction " << d;
    }
  }
}

TEST(DirectionGrid, RejectsSillySteps) {
  EXPECT_THROW(DirectionGrid(0.0), Failure);
  EXPECT_THROW(DirectionGrid(std::numeric_limits<double>::quiet_NaN()), Failure);
}

bool held(const Shaft& frame, const Vec3& apex, double tan_half, double least_m, const Box& cell) {
  for (int i = 0; i < 8; ++i) {
    const Vec3 from_apex = cell.corner(i) - apex;
    const double along_m = glm::dot(from_apex, frame.axis);
    if (along_m <= 0.0 || along_m < least_m) return false;
    if (std::abs(glm::dot(from_apex, frame.right)) > tan_half * along_m || std::abs(glm::dot(from_apex, frame.up)) > tan_half * along_m)
      return false;
  }
  return true;
}

TEST(ShaftCellSets, EqualTheBlindProduct) {
  const std::vector<double> apex_deg = {22.5, 45.0, 90.0};
  const DirectionGrid grid(22.5);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto world = random_world(seed, 4, 25);
    const Box cluster = world.hierarchy.nodes[0].bounds;
    std::vector<std::uint32_t> cells(world.subdivision.cells.size());
    std::iota(cells.begin(), cells.end(), 0U);

    std::set<CellSet> blind;
    for (std::uint32_t d = 0; d < grid.size(); ++d)
      for (const double apex : apex_deg)
        for (int octave = -12; octave <= 12; ++octave) {
          CellSet set;
          for (const auto cell : cells)
            if (held(grid.frame(d), cluster.centre(), std::tan(0.5 * apex * kDeg), cluster.diagonal() * std::exp2(octave),
                     world.subdivision.cells[cell].box))
              set.push_back(cell);
          if (set.size() >= 2) blind.insert(set);
        }
    const auto groups = group_cells(cells, world.subdivision, world.subdivision.cells.front().key.level);
    ASSERT_EQ(groups.size(), cells.size());
    std::set<CellSet> sets;
    for (const auto& set : shaft_group_sets(cluster, groups, grid, apex_deg)) sets.insert(cells_of(set, groups));
    EXPECT_EQ(sets, blind) << "seed " << seed;
    EXPECT_GT(blind.size(), 3U);

    // Directions that cannot hold a cell are left out for nothing: asked for all the same, they hold none.
    const auto all_sets = shaft_group_sets(cluster, groups, DirectionGrid(22.5, true), apex_deg);
    EXPECT_EQ(all_sets, shaft_group_sets(cluster, groups, grid, apex_deg)) << "seed " << seed;
  }
}

TEST(CellGroups, AreTheLeavesOfTheGrid) {
  // Two leaves, the second halved into four cells of which the node sees three.
  ToyWorld world = empty_toy_world();
  world.add_cell({1, {0, 0, 0}}, {Vec3(0.0), Vec3(2.0)});
  world.add_cell({2, {2, 0, 0}}, {Vec3(2.0, 0.0, 0.0), Vec3(3.0, 1.0, 1.0)});
  world.add_cell({2, {2, 0, 1}}, {Vec3(2.0, 0.0, 1.0), Vec3(3.0, 1.0, 2.0)});
  world.add_cell({2, {3, 0, 0}}, {Vec3(3.0, 0.0, 0.0), Vec3(4.0, 1.0, 1.0)});
  world.add_cell({2, {3, 0, 1}}, {Vec3(3.0, 0.0, 1.0), Vec3(4.0, 1.0, 2.0)});
  const std::vector<std::uint32_t> seen = {0, 1, 2, 4};
  const auto groups = group_cells(seen, world.subdivision, 1);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].cells, (CellSet{0}));
  EXPECT_EQ(groups[1].cells, (CellSet{1, 2, 4}));
  EXPECT_EQ(groups[1].box.min, Vec3(2.0, 0.0, 0.0));
  EXPECT_EQ(groups[1].box.max, Vec3(4.0, 1.0, 2.0));
  EXPECT_EQ(cells_of({0, 1}, groups), (CellSet{0, 1, 2, 4}));
  const auto cubes = box_cell_sets(seen, world.subdivision, 1);
  EXPECT_EQ(std::set<CellSet>(cubes.begin(), cubes.end()), (std::set<CellSet>{{1, 2, 4}}));
}

TEST(BoxCellSets, AreTheNodesOfTheGrid) {
  ToyWorld world = empty_toy_world();
  for (int i = 0; i < 4; ++i) world.add_cell({2, {i, 0, 0}}, {Vec3(i, 0.0, 0.0), Vec3(i + 1.0, 1.0, 1.0)});
  const std::vector<std::uint32_t> cells = {0, 1, 3};
  const auto sets = box_cell_sets(cells, world.subdivision);
  EXPECT_EQ(std::set<CellSet>(sets.begin(), sets.end()), (std::set<CellSet>{{0, 1}, {0, 1, 3}}));
}

}  // namespace
}  // namespace standin::test
