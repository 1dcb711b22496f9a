#include "placement/view_space/cell_locator.h"

#include <algorithm>

#include "render/base/error.h"

namespace standin {

CellLocator::CellLocator(const DyadicGrid& grid, const std::vector<CellKey>& keys, const std::vector<Box>& boxes)
    : root_min_(lookup_vector(grid.root_min)), root_side_m_(grid.root_side_m) {
  const auto unordered = std::adjacent_find(keys.begin(), keys.end(), [](const CellKey& a, const CellKey& b) { return !(a < b); });
  if (unordered != keys.end())
    throw Failure(ErrorWord::kFileBroken,
                  "cells: number " + std::to_string(unordered - keys.begin() + 1) + " does not follow its predecessor in (level, index)");
  if (keys.size() != boxes.size()) throw Failure(ErrorWord::kInternal, "cells: as many boxes as keys are needed");
  for (std::size_t id = 0; id < keys.size(); ++id)
    cells_.push_back({keys[id].level, keys[id].index, lookup_vector(boxes[id].min), lookup_vector(boxes[id].max)});
}

}  // namespace standin
