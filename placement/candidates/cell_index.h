// Which cells see which objects, and what a cluster costs in a region: the sparse table that candidates are generated from.
//
// An object is visible from a cell when it has a term in one of the cell's CPVs. Objects are named by their rank in the hierarchy, where a
// node's objects are contiguous; so are its terms within a CPV, which are sorted by rank.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "placement/view_space/subdivision.h"
#include "render/scene/hierarchy.h"

namespace standin {

/// Half-open range of ids.
struct IdRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Both references must outlive it.
class CellIndex {
 public:
  CellIndex(const Hierarchy& hierarchy, const Subdivision& subdivision);

  /// Of the view space's leaf cubes, which hot cells halve: that of the coarsest cells.
  [[nodiscard]] int leaf_level() const { return leaf_level_; }
  /// The cell's CPVs, contiguous in Subdivision::cpvs.
  [[nodiscard]] IdRange cpvs(std::uint32_t cell) const { return cpvs_[cell]; }
  /// Ranks of the objects visible from the cell, ascending.
  [[nodiscard]] std::span<const std::uint32_t> visible(std::uint32_t cell) const {
    return {visible_.data() + visible_offset_[cell], visible_.data() + visible_offset_[cell + 1]};
  }
  /// The part of visible() that lies in a node.
  [[nodiscard]] std::span<const std::uint32_t> visible_in(std::uint32_t cell, std::uint32_t node) const;
  /// Cells that see some object of the node, ascending.
  [[nodiscard]] std::vector<std::uint32_t> cells_seeing(std::uint32_t node) const;

  /// Milliseconds of the node's objects in a CPV, terms added in their order.
  [[nodiscard]] double terms_ms(const Cpv& cpv, std::uint32_t node) const;

 private:
  void collect_visible();
  void collect_cells();

  const Hierarchy& hierarchy_;
  const Subdivision& subdivision_;
  int leaf_level_ = 0;
  std::vector<IdRange> cpvs_;                  // per cell
  std::vector<std::uint64_t> visible_offset_;  // per cell + 1
  std::vector<std::uint32_t> visible_;
  std::vector<std::uint64_t> cells_offset_;  // per rank + 1
  std::vector<std::uint32_t> cells_;
};

}  // namespace standin
