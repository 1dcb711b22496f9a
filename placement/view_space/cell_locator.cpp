#include "placement/view_space/cell_locator.h"

#include <algorithm>

#include "render/base/error.h"

namespace standin {

CellLocator::CellLocator(const DyadicGrid& grid, std::vector<CellKey> keys, std::vector<Box> boxes)
    : grid_(grid), keys_(std::move(keys)), boxes_(std::move(boxes)) {
  const auto unordered = std::adjacent_find(keys_.begin(), keys_.end(), [](const CellKey& a, const CellKey& b) { return !(a < b); });
  if (unordered != keys_.end())
    throw Failure(ErrorWord::kFileBroken,
                  "cells: number " + std::to_string(unordered - keys_.begin() + 1) + " does not follow its predecessor in (level, index)");
  if (keys_.size() != boxes_.size()) throw Failure(ErrorWord::kInternal, "cells: as many boxes as keys are needed");
  if (keys_.empty()) return;
  coarsest_level_ = keys_.front().level;
  finest_level_ = keys_.back().level;
}

std::optional<std::uint32_t> CellLocator::cell_above(const std::array<int, 3>& finest_index, const Vec3& position) const {
  for (int level = finest_level_; level >= coarsest_level_; --level) {
    const int shift = finest_level_ - level;
    const CellKey key{level, {finest_index[0] >> shift, finest_index[1] >> shift, finest_index[2] >> shift}};
    const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
    if (found == keys_.end() || *found != key) continue;
    const auto id = static_cast<std::uint32_t>(found - keys_.begin());
    if (boxes_[id].contains(position)) return id;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> CellLocator::find(const Vec3& position) const {
  if (keys_.empty()) return std::nullopt;
  std::array<int, 3> index{};
  std::array<bool, 3> on_border{};  // then the slab below is closed there and may hold it too
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double coordinate = position[static_cast<int>(axis)];
    index[axis] = grid_.index_at(coordinate, static_cast<int>(axis), finest_level_);
    if (index[axis] < 0) return std::nullopt;
    const CellKey slab{finest_level_, {index[axis], index[axis], index[axis]}};
    on_border[axis] = coordinate == grid_.cube(slab).min[static_cast<int>(axis)];
  }
  // Eight ways to step down across borders; those that do not in x come first, of these those that do not in y.
  for (int down = 0; down < 8; ++down) {
    const std::array<bool, 3> step = {(down & 4) != 0, (down & 2) != 0, (down & 1) != 0};
    std::array<int, 3> at = index;
    bool possible = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      possible = possible && (!step[axis] || on_border[axis]);
      at[axis] -= step[axis] ? 1 : 0;
      possible = possible && at[axis] >= 0;
    }
    if (!possible) continue;
    if (const auto found = cell_above(at, position)) return found;
  }
  return std::nullopt;
}

}  // namespace standin
