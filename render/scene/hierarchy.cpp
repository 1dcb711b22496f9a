#include "render/scene/hierarchy.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

#include "render/scene/object_bounds.h"

namespace standin {
namespace {

using Ids = std::span<std::uint32_t>;

// Below this depth nodes are halved instead of split by area, so that no arrangement of objects (a geometric series of distances, say)
// costs quadratic time or makes a deep tree.
constexpr int kAreaDepth = 48;

double half_area(const Box& box) {
  const Vec3 s = box.size();
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t imbalance = std::numeric_limits<std::size_t>::max();
  int axis = 0;
  std::size_t left_count = 0;
  [[nodiscard]] auto key() const { return std::tie(cost, imbalance, axis, left_count); }
};

class Builder {
 public:
  explicit Builder(const Scene& scene) : scene_(scene), areas_(scene.objects.size()) {
    centres_.reserve(scene.objects.size());
    for (const Object& object : scene.objects) centres_.push_back(object.bounds.centre());
  }

  // Sorts `ids` so that its first `n` go left; returns n.
  std::size_t split(Ids ids, int depth) {
    const Split best = depth < kAreaDepth ? least_area_split(ids) : halving(ids);
    sort_along(ids, best.axis);
    return best.left_count;
  }

 private:
  void sort_along(Ids ids, int axis) const {
    std::sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double x = centres_[a][axis];
      const double y = centres_[b][axis];
      return x != y ? x < y : a < b;
    });
  }

  // Surface area heuristic: the expected number of objects a random ray has to look at.
  Split least_area_split(Ids ids) {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      sort_along(ids, axis);
      Box right;
      for (std::size_t i = ids.size(); i-- > 1;) {
        right.extend(scene_.objects[ids[i]].bounds);
        areas_[i] = half_area(right);
      }
      Box left;
      for (std::size_t n = 1; n < ids.size(); ++n) {
        left.extend(scene_.objects[ids[n - 1]].bounds);
        const std::size_t rest = ids.size() - n;
        const double cost = half_area(left) * static_cast<double>(n) + areas_[n] * static_cast<double>(rest);
        const Split candidate{cost, std::max(n, rest) - std::min(n, rest), axis, n};
        if (candidate.key() < best.key()) best = candidate;
      }
    }
    return best;
  }

  [[nodiscard]] Split halving(Ids ids) const {
    Box centres;
    for (const std::uint32_t id : ids) centres.extend(centres_[id]);
    const Vec3 s = centres.size();
    const int axis = s.x >= s.y && s.x >= s.z ? 0 : (s.y >= s.z ? 1 : 2);
    return {0.0, 0, axis, ids.size() / 2};
  }

  const Scene& scene_;
  std::vector<Vec3> centres_;
  std::vector<double> areas_;  // of the boxes right of each position
};

struct Pending {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  std::int32_t parent = -1;
  int depth = 0;
};

// Appends the node and tells its parent; the left child is always taken first, so it sees an unset `left`.
std::int32_t append_node(Hierarchy& tree, const Scene& scene, const Pending& range) {
  const auto id = static_cast<std::int32_t>(tree.nodes.size());
  HierarchyNode node;
  node.bounds = bounds_of(scene, std::span(tree.order).subspan(range.first, range.count));
  node.parent = range.parent;
  node.first = range.first;
  node.count = range.count;
  tree.nodes.push_back(node);
  if (range.parent >= 0) {
    HierarchyNode& parent = tree.nodes[static_cast<std::size_t>(range.parent)];
    (parent.left < 0 ? parent.left : parent.right) = id;
  }
  return id;
}

}  // namespace

Hierarchy build_hierarchy(const Scene& scene) {
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  Hierarchy tree;
  if (count == 0) return tree;
  tree.order.resize(count);
  std::iota(tree.order.begin(), tree.order.end(), 0U);
  tree.nodes.reserve(2 * std::size_t{count} - 1);
  Builder builder(scene);
  std::vector<Pending> stack{{0, count, -1, 0}};
  while (!stack.empty()) {
    const Pending range = stack.back();
    stack.pop_back();
    const std::int32_t id = append_node(tree, scene, range);
    if (range.count == 1) continue;
    const auto left = static_cast<std::uint32_t>(builder.split(std::span(tree.order).subspan(range.first, range.count), range.depth));
    stack.push_back({range.first + left, range.count - left, id, range.depth + 1});
    stack.push_back({range.first, left, id, range.depth + 1});
  }
  tree.rank.resize(count);
  tree.leaf.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) tree.rank[tree.order[i]] = i;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    if (tree.nodes[n].count == 1) tree.leaf[tree.order[tree.nodes[n].first]] = static_cast<std::uint32_t>(n);
  }
  return tree;
}

std::vector<std::uint32_t> objects_of(const Hierarchy& hierarchy, const HierarchyNode& node) {
  const auto first = hierarchy.order.begin() + node.first;
  std::vector<std::uint32_t> objects(first, first + node.count);
  std::sort(objects.begin(), objects.end());
  return objects;
}

}  // namespace standin
