// The object hierarchy (thesis 5.4): a binary bounding volume hierarchy over objects, whose nodes are the object clusters impostors may
// stand for.
//
// Nodes are in depth-first order, so a parent's id is smaller than its children's, and the objects of node n are the contiguous range
// order[first] .. order[first+count-1]. Built top down by the surface area heuristic over object centres; ties by object id.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

struct HierarchyNode {
  Box bounds;
  std::int32_t parent = -1;
  std::int32_t left = -1;  // -1: leaf (exactly one object)
  std::int32_t right = -1;
  std::uint32_t first = 0;  // range in Hierarchy::order
  std::uint32_t count = 0;
};

struct Hierarchy {
  std::vector<HierarchyNode> nodes;  // 2 * objects - 1; node 0 is the root
  std::vector<std::uint32_t> order;  // object ids in depth-first order
  std::vector<std::uint32_t> rank;   // rank[object] = its position in `order`
  std::vector<std::uint32_t> leaf;   // leaf[object] = its leaf node
};

[[nodiscard]] Hierarchy build_hierarchy(const Scene& scene);
/// Ids of the cluster's objects, ascending.
[[nodiscard]] std::vector<std::uint32_t> objects_of(const Hierarchy& hierarchy, const HierarchyNode& node);

}  // namespace standin
