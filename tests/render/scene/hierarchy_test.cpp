#include "render/scene/hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/rng.h"

namespace standin {
namespace {

Scene scene_of(const std::vector<Box>& boxes) {
  Scene scene;
  for (const Box& box : boxes) {
    Object object;
    object.bounds = box;
    scene.objects.push_back(object);
  }
  return scene;
}

Box box_at(const Vec3& centre, double half) {
  return {centre - half, centre + half};
}

int depth_of(const Hierarchy& tree) {
  std::vector<int> depth(tree.nodes.size(), 0);
  int deepest = 0;
  for (std::size_t n = 1; n < tree.nodes.size(); ++n) {
    depth[n] = depth[static_cast<std::size_t>(tree.nodes[n].parent)] + 1;
    deepest = std::max(deepest, depth[n]);
  }
  return deepest;
}

// What hierarchy.h promises of every tree.
void expect_lawful(const Hierarchy& tree, const Scene& scene) {
  const std::size_t count = scene.objects.size();
  ASSERT_EQ(tree.nodes.size(), 2 * count - 1);
  std::vector<std::uint32_t> sorted = tree.order;
  std::sort(sorted.begin(), sorted.end());
  for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(sorted[i], i);
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const HierarchyNode& node = tree.nodes[n];
    Box bounds;
    for (std::uint32_t i = 0; i < node.count; ++i) bounds.extend(scene.objects[tree.order[node.first + i]].bounds);
    ASSERT_EQ(node.bounds, bounds) << "node " << n;
    if (node.count == 1) {
      ASSERT_EQ(node.left, -1);
      ASSERT_EQ(node.right, -1);
      ASSERT_EQ(tree.leaf[tree.order[node.first]], n);
      ASSERT_EQ(tree.rank[tree.order[node.first]], node.first);
      continue;
    }
    const auto& left = tree.nodes[static_cast<std::size_t>(node.left)];
    const auto& right = tree.nodes[static_cast<std::size_t>(node.right)];
    ASSERT_EQ(static_cast<std::size_t>(node.left), n + 1) << "depth-first order";
    ASSERT_GT(node.right, node.left);
    ASSERT_EQ(static_cast<std::size_t>(left.parent), n);
    ASSERT_EQ(static_cast<std::size_t>(right.parent), n);
    ASSERT_EQ(left.first, node.first);
    ASSERT_EQ(right.first, node.first + left.count);
    ASSERT_EQ(left.count + right.count, node.count);
  }
}

TEST(Hierarchy, RandomBoxesObeyTheLaws) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    std::vector<Box> boxes;
    for (int i = 0; i < 200; ++i) {
      boxes.push_back(box_at({rng.uniform(0, 100), rng.uniform(0, 5), rng.uniform(0, 100)}, rng.uniform(0.1, 4)));
    }
    const Scene scene = scene_of(boxes);
    expect_lawful(build_hierarchy(scene), scene);
  }
}

TEST(Hierarchy, NoneAndOne) {
  EXPECT_TRUE(build_hierarchy(Scene()).nodes.empty());
  const Scene one = scene_of({box_at({1, 2, 3}, 1)});
  expect_lawful(build_hierarchy(one), one);
}

// Two clusters far apart: the root separates them, whatever the ids.
TEST(Hierarchy, SeparatesClusters) {
  std::vector<Box> boxes;
  for (int i = 0; i < 10; ++i) boxes.push_back(box_at({i % 2 == 0 ? i : 1000.0 + i, 0, 0}, 0.4));
  const Scene scene = scene_of(boxes);
  const Hierarchy tree = build_hierarchy(scene);
  const HierarchyNode& left = tree.nodes[static_cast<std::size_t>(tree.nodes[0].left)];
  ASSERT_EQ(left.count, 5U);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(tree.order[left.first + i] % 2, 0U);
}

// The root's split is the cheapest of all splits along the axes, by brute force.
TEST(Hierarchy, RootSplitIsTheCheapest) {
  const auto half_area = [](const Box& b) {
    const Vec3 s = b.size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
  };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed, 9);
    std::vector<Box> boxes;
    for (int i = 0; i < 12; ++i) boxes.push_back(box_at({rng.uniform(0, 9), rng.uniform(0, 9), rng.uniform(0, 9)}, rng.uniform(0.1, 2)));
    const Scene scene = scene_of(boxes);
    double cheapest = 1e300;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<std::size_t> order(boxes.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return boxes[a].centre()[axis] < boxes[b].centre()[axis]; });
      for (std::size_t n = 1; n < order.size(); ++n) {
        Box left;
        Box right;
        for (std::size_t i = 0; i < order.size(); ++i) (i < n ? left : right).extend(boxes[order[i]]);
        cheapest = std::min(cheapest, half_area(left) * static_cast<double>(n) + half_area(right) * static_cast<double>(order.size() - n));
      }
    }
    const Hierarchy tree = build_hierarchy(scene);
    double cost = 0.0;
    for (const std::int32_t child : {tree.nodes[0].left, tree.nodes[0].right}) {
      const HierarchyNode& node = tree.nodes[static_cast<std::size_t>(child)];
      cost += half_area(node.bounds) * node.count;
    }
    EXPECT_NEAR(cost, cheapest, 1e-9 * cheapest);
  }
}

TEST(Hierarchy, IdenticalBoxesMakeABalancedTreeInOrderOfIds) {
  const Scene scene = scene_of(std::vector<Box>(65536, box_at({5, 5, 5}, 1)));
  const Hierarchy tree = build_hierarchy(scene);
  expect_lawful(tree, scene);
  EXPECT_EQ(depth_of(tree), 16);
  EXPECT_TRUE(std::is_sorted(tree.order.begin(), tree.order.end()));
}

// Areas would peel off one object at a time.
TEST(Hierarchy, GeometricSeriesStaysShallow) {
  std::vector<Box> boxes;
  for (int i = 0; i < 900; ++i) boxes.push_back(box_at(Vec3(std::pow(2.0, i - 450)), std::pow(2.0, i - 453)));
  const Scene scene = scene_of(boxes);
  const Hierarchy tree = build_hierarchy(scene);
  expect_lawful(tree, scene);
  EXPECT_LE(depth_of(tree), 48 + 10);
}

TEST(Hierarchy, FlatPointsHaveNoAreaAndStillSplit) {
  std::vector<Box> boxes;
  for (int i = 0; i < 64; ++i) boxes.push_back(box_at({i, 0, 0}, 0));
  const Scene scene = scene_of(boxes);
  const Hierarchy tree = build_hierarchy(scene);
  expect_lawful(tree, scene);
  EXPECT_EQ(depth_of(tree), 6);
}

}  // namespace
}  // namespace standin
