#include "placement/view_space/cell_locator.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();

std::size_t hash_of(const CellKey& key) {
  std::uint64_t hash = static_cast<std::uint64_t>(key.level);
  for (const int index : key.index) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

}  // namespace

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
  slots_.assign(std::bit_ceil(2 * keys_.size()), kFree);
  for (std::uint32_t id = 0; id < keys_.size(); ++id) {
    std::size_t slot = hash_of(keys_[id]);
    while (slots_[slot & (slots_.size() - 1)] != kFree) ++slot;
    slots_[slot & (slots_.size() - 1)] = id;
  }
}

std::optional<std::uint32_t> CellLocator::cell_at(const CellKey& key) const {
  for (std::size_t slot = hash_of(key);; ++slot) {
    const std::uint32_t id = slots_[slot & (slots_.size() - 1)];
    if (id == kFree) return std::nullopt;
    if (keys_[id] == key) return id;
  }
}

std::optional<std::uint32_t> CellLocator::cell_above(const std::array<int, 3>& finest_index, const Vec3& position) const {
  for (int level = finest_level_; level >= coarsest_level_; --level) {
    const int shift = finest_level_ - level;
    const CellKey key{level, {finest_index[0] >> shift, finest_index[1] >> shift, finest_index[2] >> shift}};
    const auto id = cell_at(key);
    if (id && boxes_[*id].contains(position)) return id;
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
