// The boxes of a view space sorted into its leaf cubes, so that the boxes of thousands of cells come without scanning all of them each
// time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/view_space/view_space.h"

namespace standin {

/// `view_space` must outlive it. Const members may be called from several threads.
class CellBoxes {
 public:
  explicit CellBoxes(const ViewSpace& view_space);

  /// Leaf-level cubes that hold a part of the view space, ascending.
  [[nodiscard]] const std::vector<CellKey>& leaves() const { return leaves_; }
  /// As ViewSpace::cell_box; fast at the leaf level and below.
  [[nodiscard]] Box cell_box(const CellKey& key) const;
  /// The boxes' parts inside the cube of `key` (leaf level or below).
  [[nodiscard]] std::vector<Box> parts(const CellKey& key) const;
  /// Boxes of the cell and its ancestors up to the leaf level, the cell's first.
  [[nodiscard]] std::vector<Box> chain(CellKey key) const;

 private:
  [[nodiscard]] std::span<const std::uint32_t> candidates(const CellKey& key) const;

  const ViewSpace* view_space_;
  std::vector<CellKey> leaves_;
  std::vector<std::size_t> offset_;     // per leaf + 1, into box_ids_
  std::vector<std::uint32_t> box_ids_;  // ascending within a leaf
};

[[nodiscard]] bool has_more_leaves_than(const ViewSpace& view_space, std::uint64_t limit);

}  // namespace standin
