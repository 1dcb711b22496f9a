// The node tree as ranges of a depth-first numbering, so that "is inside" is two comparisons.
//
// Node n and everything below it are exactly the ranks first(n) .. last(n). Built without recursion: trees may be 10,000 deep.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace standin {

class TreeOrder {
 public:
  /// `parent[n]` < n, or -1 for a root.
  explicit TreeOrder(std::span<const std::int32_t> parent);

  [[nodiscard]] std::uint32_t first(std::uint32_t node) const { return first_[node]; }
  [[nodiscard]] std::uint32_t last(std::uint32_t node) const { return last_[node]; }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> last_;
};

}  // namespace standin
