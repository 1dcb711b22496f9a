#include "placement/view_space/view_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/cell_locator.h"
#include "placement/view_space/subdivision.h"
#include "render/base/error.h"
#include "tests/support/ascii_world.h"

namespace standin {
namespace {

constexpr std::uint64_t kSeed = 20240;

ErrorWord word_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Failure& failure) {
    return failure.word();
  }
  return ErrorWord::kInternal;
}

std::vector<Box> random_boxes(Rng& rng, int count, double extent_m) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = rng.uniform(-extent_m, extent_m);
      box.max[axis] = box.min[axis] + (rng.below(4) == 0 ? 0.0 : rng.uniform(0.0, 0.4 * extent_m));
    }
    boxes.push_back(box);
  }
  return boxes;
}

TEST(ViewSpace, LeavesOfAFlatBoxAreCountedByHand) {
  // 50 m in leaves of 23 m: three a side; the root is the next power of two.
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {50, 0.2, 50}}}, {});
  EXPECT_EQ(space.leaf_level, 2);
  EXPECT_EQ(space.finest_level, 5);
  EXPECT_EQ(space.root_side_m, 92.0);
  EXPECT_EQ(leaf_keys(space).size(), 9U);
  EXPECT_EQ(space.cell_box({2, {2, 0, 0}}), (Box{{46, 0, 0}, {50, 0.2, 23}}));
  EXPECT_TRUE(space.cell_box({2, {3, 0, 0}}).empty());
}

TEST(ViewSpace, ABoxThatEndsOnABorderHasNoPartBeyondIt) {
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {46, 0, 23}}, {{69, 0, 0}, {70, 0, 1}}}, {});
  EXPECT_THAT(leaf_keys(space), testing::ElementsAre(CellKey{2, {0, 0, 0}}, CellKey{2, {1, 0, 0}}, CellKey{2, {3, 0, 0}}));
}

TEST(ViewSpace, AnExtentOfOneLeafIsTheRoot) {
  const ViewSpace space = make_box_view_space({{{1, 2, 3}, {24, 2, 3}}}, {});
  EXPECT_EQ(space.leaf_level, 0);
  EXPECT_EQ(space.cell_box({0, {0, 0, 0}}), space.boxes[0]);
}

TEST(ViewSpace, AFlatBoxOnABorderBelongsToTheUpperCube) {
  const Box wall{{23, 0, 0}, {23, 1, 1}};
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {1, 1, 1}}, wall, {{45, 0, 0}, {46, 1, 1}}}, {});
  EXPECT_TRUE(space.leaf_level == 1);
  EXPECT_EQ(space.cell_box({1, {0, 0, 0}}), (Box{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(space.cell_box({1, {1, 0, 0}}), (Box{{23, 0, 0}, {46, 1, 1}}));
}

TEST(ViewSpace, AFlatBoxOnTheRootsLastBorderIsKept) {
  const Box wall{{23, 0, 0}, {23, 1, 1}};
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {1, 1, 1}}, wall}, {});
  EXPECT_EQ(space.leaf_level, 0);
  EXPECT_EQ(space.cell_box({1, {1, 0, 0}}), wall);
}

TEST(ViewSpace, BordersOfAllLevelsAgreeToTheLastBit) {
  const DyadicGrid grid{{0.1, -1e5 / 3.0, 7.7}, 0.1 * 1024};
  for (const int i : {0, 1, 333, 777, 1023}) {
    const Box fine = grid.cube({10, {i, i, i}});
    EXPECT_EQ(fine.min, grid.cube({11, {2 * i, 2 * i, 2 * i}}).min);
    EXPECT_EQ(fine.max, grid.cube({11, {2 * i + 1, 2 * i + 1, 2 * i + 1}}).max);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(grid.index_at(fine.min[axis], axis, 10), i);
      EXPECT_EQ(grid.index_at(std::nextafter(fine.max[axis], -1e9), axis, 10), i);
      EXPECT_EQ(grid.index_at(fine.max[axis], axis, 10), i + 1);
    }
  }
  EXPECT_EQ(grid.index_at(0.0, 0, 10), -1);
}

TEST(ViewSpace, LeavesAreDoubledBeyondTheLimitAndThatIsSaid) {
  ViewSpaceOptions options;
  options.max_leaves = 4;
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {91, 0, 91}}}, options);  // 4 x 4 leaves of 23 m
  EXPECT_EQ(leaf_keys(space).size(), 4U);
  EXPECT_THAT(space.left_out, testing::ElementsAre("leaves of 46 m instead of 23 m: more than 4 otherwise"));
}

TEST(ViewSpace, ABoxOfManyCubesIsNotEnumerated) {
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {1e6, 1e6, 1e6}}}, {});
  EXPECT_LE(leaf_keys(space).size(), 20'000U);
}

TEST(ViewSpace, WrongInputIsRefusedByWord) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ViewSpaceOptions no_leaf;
  no_leaf.leaf_m = 0.0;
  EXPECT_EQ(word_of([] { (void)make_box_view_space({}, {}); }), ErrorWord::kViewSpaceEmpty);
  EXPECT_EQ(word_of([] { (void)make_path_view_space({}, 1.0, {}); }), ErrorWord::kViewSpaceEmpty);
  EXPECT_EQ(word_of([&] { (void)make_box_view_space({{{0, 0, 0}, {nan, 1, 1}}}, {}); }), ErrorWord::kBadUsage);
  EXPECT_EQ(word_of([] { (void)make_box_view_space({{{1, 0, 0}, {0, 1, 1}}}, {}); }), ErrorWord::kBadUsage);
  EXPECT_EQ(word_of([&] { (void)make_box_view_space({{{0, 0, 0}, {1, 1, 1}}}, no_leaf); }), ErrorWord::kBadUsage);
  EXPECT_EQ(word_of([] { (void)make_path_view_space({{0, 0, 0}}, -1.0, {}); }), ErrorWord::kBadUsage);
}

TEST(ViewSpace, APathIsABoxAroundEachPoint) {
  const ViewSpace space = make_path_view_space({{5, 0, 0}, {0, 0, 0}, {5, 0, 0}}, 0.5, {});
  ASSERT_EQ(space.boxes.size(), 2U);
  EXPECT_EQ(space.boxes[0], (Box{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}));
}

TEST(ViewSpace, PositionsAreDrawnByVolume) {
  const ViewSpace space = make_box_view_space({{{0, 0, 0}, {1, 0, 1}}, {{10, 0, 0}, {13, 0, 1}}}, {});
  Rng rng(kSeed);
  int in_second = 0;
  constexpr int kDraws = 20'000;
  for (int i = 0; i < kDraws; ++i) {
    const Vec3 position = space.sample_position(rng);
    ASSERT_TRUE(space.boxes[0].contains(position) || space.boxes[1].contains(position));
    in_second += space.boxes[1].contains(position) ? 1 : 0;
  }
  EXPECT_NEAR(in_second / double{kDraws}, 0.75, 0.015);  // 5 standard deviations
}

TEST(ViewSpace, OneObjectOrCompactExtentsAreOrbited) {
  std::string why;
  EXPECT_EQ(default_view_space(test::ascii_world({"."}), why), ViewSpaceKind::kOrbit);
  EXPECT_EQ(default_view_space(test::ascii_world({"#."}), why), ViewSpaceKind::kOrbit);
  EXPECT_EQ(default_view_space(test::ascii_world({"#...", "...."}), why), ViewSpaceKind::kWalk);
  EXPECT_THAT(why, testing::HasSubstr("40 x 8 x 20 m"));
}

// The fast cell boxes against the plain scan, and every position in exactly the cell that the border rule says.
TEST(CellBoxes, AgreeWithTheScanAndCoverEveryPosition) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Rng rng(kSeed);
  for (int round = 0; round < 20; ++round) {
    ViewSpaceOptions options;
    options.leaf_m = rng.uniform(0.1, 2.0);
    const ViewSpace space = make_box_view_space(random_boxes(rng, 12, 3.0), options);
    const CellBoxes cells(space);
    std::vector<CellKey> keys;
    std::vector<Box> boxes;
    for (const CellKey& leaf : cells.leaves()) {
      ASSERT_EQ(cells.cell_box(leaf), space.cell_box(leaf));
      ASSERT_FALSE(cells.cell_box(leaf).empty());
      // Half of the leaves are halved, so that the locator meets two levels.
      if (rng.below(2) == 0) {
        keys.push_back(leaf);
        continue;
      }
      for (int c = 0; c < 8; ++c) {
        ASSERT_EQ(cells.cell_box(leaf.child(c)), space.cell_box(leaf.child(c)));
        if (!cells.cell_box(leaf.child(c)).empty()) keys.push_back(leaf.child(c));
      }
    }
    std::sort(keys.begin(), keys.end());
    for (const CellKey& key : keys) boxes.push_back(cells.cell_box(key));
    const CellLocator locator(space.grid(), keys, boxes);
    for (int i = 0; i < 500; ++i) {
      const Vec3 position = space.sample_position(rng);
      const auto cell = locator.find(position);
      ASSERT_TRUE(cell.has_value());
      ASSERT_TRUE(boxes[*cell].contains(position));
    }
    for (const Box& box : space.boxes)
      for (int c = 0; c < 8; ++c) ASSERT_TRUE(locator.find(box.corner(c)).has_value());
  }
}

}  // namespace
}  // namespace standin
