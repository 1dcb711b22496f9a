// Which cell holds a position: the one place that knows the border rule.
//
// Cells are half-open at the upper end, the last one closed: of the leaf cells whose closed box holds the position, it is the one in whose
// cube the position is not on the upper border in x, if there is one; then likewise in y, then in z. A cube's box may end before the cube
// does, so a position can lie in a cube and in no cell.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "placement/view_space/view_space.h"

namespace standin {

class CellLocator {
 public:
  /// Cell ids are indices into `keys`, which must be ascending; throws Failure(kFileBroken) when they are not. No cell may be an ancestor
  /// of another.
  CellLocator(const DyadicGrid& grid, std::vector<CellKey> keys, std::vector<Box> boxes);
  /// Allocates nothing.
  [[nodiscard]] std::optional<std::uint32_t> find(const Vec3& position) const;

 private:
  [[nodiscard]] std::optional<std::uint32_t> cell_at(const CellKey& key) const;
  [[nodiscard]] std::optional<std::uint32_t> cell_above(const std::array<int, 3>& finest_index, const Vec3& position) const;

  DyadicGrid grid_;
  std::vector<CellKey> keys_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> slots_;  // open addressing by key, at most half full; kFree or a cell id
  int coarsest_level_ = 0;
  int finest_level_ = 0;
};

}  // namespace standin
