#include "placement/candidates/cell_index.h"

#include <algorithm>
#include <numeric>

namespace standin {

CellIndex::CellIndex(const Hierarchy& hierarchy, const Subdivision& subdivision)
    : hierarchy_(hierarchy), subdivision_(subdivision), cpvs_(subdivision.cells.size()) {
  for (std::uint32_t p = 0; p < subdivision.cpvs.size(); ++p) {
    IdRange& range = cpvs_[subdivision.cpvs[p].cell];
    if (range.end == 0) range.begin = p;
    range.end = p + 1;
  }
  if (!subdivision.cells.empty())
    leaf_level_ = std::ranges::min(subdivision.cells, {}, [](const Cell& cell) { return cell.key.level; }).key.level;
  collect_visible();
  collect_cells();
}

void CellIndex::collect_visible() {
  visible_offset_.push_back(0);
  std::vector<std::uint32_t> ranks;
  for (const IdRange& range : cpvs_) {
    ranks.clear();
    for (std::uint32_t p = range.begin; p < range.end; ++p) {
      const Cpv& cpv = subdivision_.cpvs[p];
      for (std::uint64_t t = cpv.first_term; t < cpv.first_term + cpv.term_count; ++t)
        ranks.push_back(hierarchy_.rank[subdivision_.terms[t].object]);
    }
    std::sort(ranks.begin(), ranks.end());
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    visible_.insert(visible_.end(), ranks.begin(), ranks.end());
    visible_offset_.push_back(visible_.size());
  }
}

void CellIndex::collect_cells() {
  cells_offset_.assign(hierarchy_.order.size() + 1, 0);
  for (const std::uint32_t rank : visible_) ++cells_offset_[rank + 1];
  std::partial_sum(cells_offset_.begin(), cells_offset_.end(), cells_offset_.begin());
  cells_.resize(visible_.size());
  std::vector<std::uint64_t> next(cells_offset_.begin(), cells_offset_.end() - 1);
  for (std::uint32_t cell = 0; cell < cpvs_.size(); ++cell)
    for (const std::uint32_t rank : visible(cell)) cells_[next[rank]++] = cell;
}

std::span<const std::uint32_t> CellIndex::visible_in(std::uint32_t cell, std::uint32_t node) const {
  const auto all = visible(cell);
  const HierarchyNode& range = hierarchy_.nodes[node];
  const auto begin = std::lower_bound(all.begin(), all.end(), range.first);
  return {begin, std::lower_bound(begin, all.end(), range.first + range.count)};
}

std::vector<std::uint32_t> CellIndex::cells_seeing(std::uint32_t node) const {
  const HierarchyNode& range = hierarchy_.nodes[node];
  std::vector<std::uint32_t> result(cells_.begin() + static_cast<std::ptrdiff_t>(cells_offset_[range.first]),
                                    cells_.begin() + static_cast<std::ptrdiff_t>(cells_offset_[range.first + range.count]));
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

double CellIndex::terms_ms(const Cpv& cpv, std::uint32_t node) const {
  const HierarchyNode& range = hierarchy_.nodes[node];
  const auto terms = std::span(subdivision_.terms).subspan(cpv.first_term, cpv.term_count);
  auto term = std::lower_bound(terms.begin(), terms.end(), range.first,
                               [&](const RegionTerm& t, std::uint32_t rank) { return hierarchy_.rank[t.object] < rank; });
  double sum_ms = 0.0;
  for (; term != terms.end() && hierarchy_.rank[term->object] < range.first + range.count; ++term) sum_ms += term->predicted_ms;
  return sum_ms;
}

}  // namespace standin
