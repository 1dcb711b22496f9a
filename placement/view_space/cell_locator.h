// Which cell holds a position, over the cells of the program: the lookup that ships (runtime/placement_lookup.h, which has the border
// rule).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "placement/view_space/view_space.h"
#include "render/base/placement_lookup.h"

namespace standin {

[[nodiscard]] inline LookupVector lookup_vector(const Vec3& v) {
  return {v.x, v.y, v.z};
}

class CellLocator {
 public:
  /// Cell ids are indices into `keys`, which must be ascending; throws Failure(kFileBroken) when they are not. No cell may be an ancestor
  /// of another.
  CellLocator(const DyadicGrid& grid, const std::vector<CellKey>& keys, const std::vector<Box>& boxes);
  /// Allocates nothing.
  [[nodiscard]] std::optional<std::uint32_t> find(const Vec3& position) const { return find_cell(view(), lookup_vector(position)); }
  /// The cells, without intervals and CPVs.
  [[nodiscard]] PlacementView view() const { return {root_min_, root_side_m_, cells_, {}, {}, 0}; }

 private:
  LookupVector root_min_;
  double root_side_m_;
  std::vector<LookupCell> cells_;
};

}  // namespace standin
