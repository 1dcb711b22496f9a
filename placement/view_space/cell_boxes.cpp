#include "placement/view_space/cell_boxes.h"

#include <algorithm>
#include <set>

#include "placement/view_space/subdivision.h"

namespace standin {
namespace {

/// Leaf cubes that the closed box reaches into or touches: indices first..last on each axis.
struct CubeRange {
  std::array<int, 3> first{}, last{};

  CubeRange(const ViewSpace& space, const Box& box) {
    const int end = 1 << space.leaf_level;
    for (int axis = 0; axis < 3; ++axis) {
      first[static_cast<std::size_t>(axis)] = std::clamp(space.grid().index_at(box.min[axis], axis, space.leaf_level), 0, end - 1);
      last[static_cast<std::size_t>(axis)] = std::clamp(space.grid().index_at(box.max[axis], axis, space.leaf_level), 0, end - 1);
    }
  }
  [[nodiscard]] double count() const {
    double product = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) product *= last[axis] - first[axis] + 1;
    return product;
  }
};

// visit(key) for every leaf cube that holds a part of the box, until it returns false; false if it did.
template <class Visit>
bool for_leaf_cubes(const ViewSpace& space, const Box& box, const Visit& visit) {
  const CubeRange range(space, box);
  for (int i = range.first[0]; i <= range.last[0]; ++i)
    for (int j = range.first[1]; j <= range.last[1]; ++j)
      for (int k = range.first[2]; k <= range.last[2]; ++k) {
        const CellKey key{space.leaf_level, {i, j, k}};
        if (!part_inside(box, space.grid(), key).empty() && !visit(key)) return false;
      }
  return true;
}

}  // namespace

bool has_more_leaves_than(const ViewSpace& view_space, std::uint64_t limit) {
  std::set<CellKey> keys;
  const auto within_limit = [&](const CellKey& key) {
    keys.insert(key);
    return keys.size() <= limit;
  };
  for (const Box& box : view_space.boxes) {
    // At most one layer of cubes on each side is touched without holding a part: this many more are never all empty.
    if (CubeRange(view_space, box).count() > 8.0 * static_cast<double>(limit) + 64.0) return true;
    if (!for_leaf_cubes(view_space, box, within_limit)) return true;
  }
  return false;
}

CellBoxes::CellBoxes(const ViewSpace& view_space) : view_space_(&view_space) {
  std::vector<std::pair<CellKey, std::uint32_t>> pairs;
  for (std::uint32_t id = 0; id < view_space.boxes.size(); ++id)
    for_leaf_cubes(view_space, view_space.boxes[id], [&](const CellKey& key) {
      pairs.emplace_back(key, id);
      return true;
    });
  std::sort(pairs.begin(), pairs.end());
  box_ids_.reserve(pairs.size());
  for (const auto& [key, id] : pairs) {
    if (leaves_.empty() || leaves_.back() != key) {
      leaves_.push_back(key);
      offset_.push_back(box_ids_.size());
    }
    box_ids_.push_back(id);
  }
  offset_.push_back(box_ids_.size());
}

std::span<const std::uint32_t> CellBoxes::candidates(const CellKey& key) const {
  CellKey leaf = key;
  while (leaf.level > view_space_->leaf_level) leaf = leaf.parent();
  const auto found = std::lower_bound(leaves_.begin(), leaves_.end(), leaf);
  if (found == leaves_.end() || *found != leaf) return {};
  const auto at = static_cast<std::size_t>(found - leaves_.begin());
  return std::span(box_ids_).subspan(offset_[at], offset_[at + 1] - offset_[at]);
}

Box CellBoxes::cell_box(const CellKey& key) const {
  if (key.level < view_space_->leaf_level) return view_space_->cell_box(key);
  Box all;
  for (const std::uint32_t id : candidates(key)) all.extend(part_inside(view_space_->boxes[id], view_space_->grid(), key));
  return all;
}

std::vector<Box> CellBoxes::parts(const CellKey& key) const {
  std::vector<Box> result;
  for (const std::uint32_t id : candidates(key)) {
    const Box part = part_inside(view_space_->boxes[id], view_space_->grid(), key);
    if (!part.empty()) result.push_back(part);
  }
  return result;
}

std::vector<Box> CellBoxes::chain(CellKey key) const {
  std::vector<Box> boxes = {cell_box(key)};
  while (key.level > view_space_->leaf_level) boxes.push_back(cell_box(key = key.parent()));
  return boxes;
}

std::vector<CellKey> leaf_keys(const ViewSpace& view_space) {
  return CellBoxes(view_space).leaves();
}

}  // namespace standin
