#include "placement/runtime/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "placement/view_space/cell_boxes.h"
#include "render/base/error.h"
#include "tests/placement/runtime/count_allocations.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 88;

// A random placement over a random view space: cells of up to three levels, intervals of two, CPVs in a third of the regions.
struct RandomPlacement {
  ViewSpace space;
  Placement placement;

  explicit RandomPlacement(Rng& rng) {
    std::vector<Box> boxes;
    for (int i = 0; i < 8; ++i) {
      Box box;
      for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = static_cast<double>(rng.below(8));
        box.max[axis] = box.min[axis] + 0.5 * static_cast<double>(rng.below(5));  // often on borders, sometimes flat
      }
      boxes.push_back(box);
    }
    ViewSpaceOptions options;
    options.leaf_m = 2.0;
    space = make_box_view_space(boxes, options);
    placement.root_min = space.root_min;
    placement.root_side_m = space.root_side_m;
    const CellBoxes cells(space);
    for (const CellKey& leaf : cells.leaves()) add_cells(cells, leaf, rng);
    std::sort(placement.cells.begin(), placement.cells.end(), [](const PlacementCell& a, const PlacementCell& b) { return a.key < b.key; });
    std::set<DirectionInterval> intervals;
    for (int i = 0; i < 200; ++i) add_interval(intervals, rng);
    placement.intervals.assign(intervals.begin(), intervals.end());
    for (std::uint32_t cell = 0; cell < placement.cells.size(); ++cell)
      for (std::uint32_t interval = 0; interval < placement.intervals.size(); ++interval)
        if (rng.below(3) == 0) placement.cpvs.push_back({cell, interval, 0.0, 0.0, false, {}});
  }

  void add_cells(const CellBoxes& cells, const CellKey& key, Rng& rng) {
    const Box box = cells.cell_box(key);
    if (box.empty()) return;
    if (key.level == space.finest_level || rng.below(2) == 0) {
      placement.cells.push_back({key, box, -1});
      return;
    }
    for (int c = 0; c < 8; ++c) add_cells(cells, key.child(c), rng);
  }

  static void add_interval(std::set<DirectionInterval>& intervals, Rng& rng) {
    const DirectionInterval coarse{static_cast<Face>(rng.below(6)), 2, static_cast<int>(rng.below(4)), static_cast<int>(rng.below(4))};
    for (int k = 0; k < 4; ++k)
      if (intervals.contains(coarse.child(k))) return;
    if (rng.below(2) == 0) {
      intervals.insert(coarse);
    } else if (!intervals.contains(coarse)) {
      intervals.insert(coarse.child(static_cast<int>(rng.below(4))));
    }
  }
};

// The rule as the contract words it: half-open at the upper end, the last one closed. Of the cells whose closed box holds the position, the
// one where it is below the cube's upper border in x, then in y, then in z.
std::optional<std::uint32_t> scan_cells(const RandomPlacement& world, const Vec3& p) {
  std::optional<std::uint32_t> best;
  const auto below_upper_border = [&](std::uint32_t id) {
    const Vec3 upper = world.space.cube(world.placement.cells[id].key).max;
    return std::array{p.x < upper.x, p.y < upper.y, p.z < upper.z};
  };
  for (std::uint32_t id = 0; id < world.placement.cells.size(); ++id)
    if (world.placement.cells[id].box.contains(p) && (!best || below_upper_border(id) > below_upper_border(*best))) best = id;
  return best;
}

// Faces by the largest component, ties x before y before z; angles half-open at the upper end, the last closed.
bool interval_holds(const DirectionInterval& interval, const Vec3& d) {
  const Vec3 size = glm::abs(d);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (static_cast<int>(interval.face) != 2 * axis + (d[axis] > 0 ? 0 : 1)) return false;
  const FaceFrame& frame = face_frame(interval.face);
  const auto holds = [&](double along, int index) {
    const double step = std::numbers::pi / 2.0 / (1 << interval.level), low = -std::numbers::pi / 4.0 + index * step;
    const double angle = std::atan2(along, glm::dot(d, frame.n));
    return angle >= low && (angle < low + step || index + 1 == 1 << interval.level);
  };
  return holds(glm::dot(d, frame.u), interval.i) && holds(glm::dot(d, frame.v), interval.j);
}

std::optional<std::uint32_t> scan_cpvs(const Placement& placement, std::uint32_t cell, const Vec3& direction) {
  for (std::uint32_t id = 0; id < placement.cpvs.size(); ++id)
    if (placement.cpvs[id].cell == cell && interval_holds(placement.intervals[placement.cpvs[id].interval], direction)) return id;
  return std::nullopt;
}

// In or about a random cell; two thirds of the coordinates on its borders.
Vec3 random_position(const Placement& placement, Rng& rng) {
  const Box& box = placement.cells[rng.below(placement.cells.size())].box;
  Vec3 position(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t kind = rng.below(12);
    position[axis] = kind < 4   ? box.min[axis]
                     : kind < 8 ? box.max[axis]
                                : rng.uniform(box.min[axis], kind < 11 ? box.max[axis] : box.max[axis] + 1.0);
  }
  return position;
}

Vec3 random_direction(Rng& rng) {
  Vec3 direction(0.0);
  while (direction == Vec3(0.0))
    for (int axis = 0; axis < 3; ++axis)  // ties and face borders among them
      direction[axis] = rng.below(2) == 0 ? static_cast<double>(rng.below(3)) - 1.0 : rng.uniform(-1.0, 1.0);
  return direction;
}

TEST(PlacementIndex, AgreesWithALinearScanOnBordersToo) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Rng rng(kSeed);
  int in_cells = 0, in_cpvs = 0;
  for (int round = 0; round < 12; ++round) {
    const RandomPlacement world(rng);
    const PlacementIndex index(world.placement);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 position = random_position(world.placement, rng), direction = random_direction(rng);
      const Lookup found = index.find(position, direction);
      const auto cell = scan_cells(world, position);
      ASSERT_EQ(found.cell, cell);
      ASSERT_EQ(found.cpv, cell ? scan_cpvs(world.placement, *cell, direction) : std::nullopt);
      in_cells += found.cell ? 1 : 0;
      in_cpvs += found.cpv ? 1 : 0;
    }
  }
  EXPECT_GT(in_cells, 12'000);
  EXPECT_GT(in_cpvs, 1000);
}

TEST(PlacementIndex, FindAllocatesNothing) {
  Rng rng(kSeed);
  const RandomPlacement world(rng);
  const PlacementIndex index(world.placement);
  const Vec3 inside = world.placement.cells[0].box.centre();
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 100; ++i) (void)index.find(i % 2 == 0 ? inside : random_position(world.placement, rng), random_direction(rng));
  EXPECT_EQ(test::allocation_count() - before, 0U);
}

// Two cells side by side, [0, 1] and [1, 2] in x; one interval each.
Placement two_cells() {
  Placement placement;
  placement.root_side_m = 2.0;
  placement.cells = {{{1, {0, 0, 0}}, {{0, 0, 0}, {1, 1, 1}}, 0}, {{1, {1, 0, 0}}, {{1, 0, 0}, {2, 1, 1}}, -1}};
  placement.intervals = {{Face::kPosX, 0, 0, 0}};
  placement.visible_sets = {{0, 2, 4, 5}};
  placement.cpvs = {{0, 0, 9.0, 4.0, true, {0, 1}}};
  placement.impostors.resize(2);
  placement.impostors[0].objects = {1, 2};
  placement.impostors[1].objects = {5};
  return placement;
}

TEST(PlacementIndex, CellsAreHalfOpenAndTheLastOneClosed) {
  const Placement placement = two_cells();
  const PlacementIndex index(placement);
  EXPECT_EQ(index.find({0, 0, 0}, {1, 0, 0}).cell, 0U);
  EXPECT_EQ(index.find({1, 0, 0}, {1, 0, 0}).cell, 1U);
  EXPECT_EQ(index.find({2, 1, 1}, {1, 0, 0}).cell, 1U);
  EXPECT_EQ(index.find({std::nextafter(2.0, 3.0), 0, 0}, {1, 0, 0}).cell, std::nullopt);
  EXPECT_EQ(index.find({-1e-300, 0, 0}, {1, 0, 0}).cell, std::nullopt);
  EXPECT_EQ(index.find({std::numeric_limits<double>::quiet_NaN(), 0, 0}, {1, 0, 0}).cell, std::nullopt);
  EXPECT_EQ(index.find({1, 0, 0}, {1, 0, 0}).cpv, std::nullopt);
  EXPECT_EQ(index.find({0.5, 0, 0}, {3, 3, 3}).cpv, 0U);  // the tie goes to x
  EXPECT_EQ(index.find({0.5, 0, 0}, {1, 1.1, 0}).cpv, std::nullopt);
}

TEST(ContentOf, DrawsImpostorsInsteadOfTheirObjects) {
  const Placement placement = two_cells();
  const PlacementIndex index(placement);
  const ViewContent replaced = content_of(placement, index.find({0.5, 0.5, 0.5}, {1, 0, 0}), 6);
  EXPECT_THAT(replaced.objects, testing::ElementsAre(0, 4));  // visible, and not 1, 2 or 5
  EXPECT_THAT(replaced.impostors, testing::ElementsAre(0, 1));
  const ViewContent originals = content_of(placement, index.find({0.5, 0.5, 0.5}, {-1, 0, 0}), 6);
  EXPECT_THAT(originals.objects, testing::ElementsAre(0, 2, 4, 5));
  EXPECT_TRUE(originals.impostors.empty());
  EXPECT_THAT(content_of(placement, index.find({1.5, 0.5, 0.5}, {1, 0, 0}), 3).objects, testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(content_of(placement, index.find({7, 7, 7}, {1, 0, 0}), 3).objects, testing::ElementsAre(0, 1, 2));
}

// Object 2's bounds lie 3 m from the first cell and 2 m from the second.
TEST(ContentOf, ChoosesLevelsOfDetailByTheCellsDistance) {
  Placement placement = two_cells();
  placement.levels = {{2, Box{{4, 0, 0}, {5, 1, 1}}, {2.5, 3.0, 3.5}}, {5, Box{{-9, 0, 0}, {-8, 1, 1}}, {1.0}}};
  const PlacementIndex index(placement);
  const ViewContent first = content_of(placement, index.find({0.5, 0.5, 0.5}, {-1, 0, 0}), 6);
  EXPECT_THAT(first.objects, testing::ElementsAre(0, 2, 4, 5));
  EXPECT_THAT(first.levels, testing::ElementsAre(0, 2, 0, 1));  // 3.0 m is far enough for its second level
  const ViewContent replaced = content_of(placement, index.find({0.5, 0.5, 0.5}, {1, 0, 0}), 6);
  EXPECT_THAT(replaced.objects, testing::ElementsAre(0, 4));
  EXPECT_THAT(replaced.levels, testing::ElementsAre(0, 0));
  const ViewContent second = content_of(placement, index.find({1.5, 0.5, 0.5}, {1, 0, 0}), 6);
  EXPECT_THAT(second.levels, testing::ElementsAre(0, 0, 0, 0, 0, 1));
  EXPECT_TRUE(content_of(placement, index.find({7, 7, 7}, {1, 0, 0}), 6).levels.empty());
}

TEST(PlacementIndex, RefusesADisorderedPlacementByWord) {
  const auto word = [](const Placement& placement) {
    try {
      const PlacementIndex index(placement);
    } catch (const Failure& failure) {
      return failure.word();
    }
    return ErrorWord::kInternal;
  };
  Placement cells = two_cells(), interval = two_cells(), impostor = two_cells(), twice = two_cells();
  std::swap(cells.cells[0], cells.cells[1]);
  interval.cpvs[0].interval = 1;
  impostor.cpvs[0].impostors = {2};
  twice.cpvs.push_back(twice.cpvs[0]);
  for (const Placement& placement : {cells, interval, impostor, twice}) EXPECT_EQ(word(placement), ErrorWord::kFileBroken);
}

TEST(PlacementIndex, AnEmptyPlacementHoldsNothing) {
  const Placement placement;
  EXPECT_EQ(PlacementIndex(placement).find({0, 0, 0}, {1, 0, 0}).cell, std::nullopt);
}

}  // namespace
}  // namespace standin
