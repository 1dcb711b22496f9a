#include "placement/select/tree_order.h"

#include <numeric>

namespace standin {

TreeOrder::TreeOrder(std::span<const std::int32_t> parent) : first_(parent.size()), last_(parent.size()) {
  std::vector<std::uint32_t> size(parent.size(), 1);
  for (std::size_t n = parent.size(); n-- > 0;)
    if (parent[n] >= 0) size[static_cast<std::size_t>(parent[n])] += size[n];

  // Parents come before their children, so each node's first free rank is known when a child asks for it.
  std::vector<std::uint32_t> free_rank(parent.size());
  std::uint32_t free_root = 0;
  for (std::size_t n = 0; n < parent.size(); ++n) {
    auto& slot = parent[n] < 0 ? free_root : free_rank[static_cast<std::size_t>(parent[n])];
    first_[n] = slot;
    last_[n] = slot + size[n] - 1;
    slot += size[n];
    free_rank[n] = first_[n] + 1;
  }
}

}  // namespace standin
