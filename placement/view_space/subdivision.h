// Problem view space approximation (thesis 5.5): the regions (3D cell x direction interval) whose time bound exceeds the budget.
//
// Every leaf cube of the view space gets a quadtree search over directions; a node whose bound (region_bound.h) is within the budget is
// pruned with everything below it. We start at the leaf level, not at the root as the paper does: visible sets belong to leaves, and what
// the root could prune costs less than its sets. Hot leaves are halved further in position, the hottest first, each sub-leaf a cell of its
// own: demand is bound minus budget, so a tighter bound saves many times its cost in impostor memory.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "placement/view_space/region_bound.h"
#include "placement/view_space/search_memory.h"
#include "placement/view_space/view_space.h"
#include "render/base/work.h"
#include "render/view/direction_interval.h"
#include "render/view/enclosing_region.h"

namespace standin {

/// Leaf of the 3D subdivision.
struct Cell {
  CellKey key;
  Box box;
  std::int32_t visible_set = -1;     // index into Subdivision::visible_sets; -1: everything may be visible
  double worst_predicted_ms = 0.0;   // greatest bound of its leaf regions, in budget or not
  DirectionInterval worst_interval;  // where that is
};

/// Conservative problem view: a leaf region over budget.
struct Cpv {
  std::uint32_t cell = 0;
  std::uint32_t interval = 0;    // index into Subdivision::intervals
  bool pixels_capped = false;    // the linear form chosen
  double constant_ms = 0.0;      // predicted: the frame's own cost, and the pixel cap where capped
  double predicted_ms = 0.0;     // constant_ms plus all terms, summed in term order
  std::uint64_t first_term = 0;  // range in Subdivision::terms
  std::uint32_t term_count = 0;
};

struct Subdivision {
  std::vector<Cell> cells;                   // all leaves, sorted by key; cells without CPVs included
  std::vector<DirectionInterval> intervals;  // those that CPVs use, sorted
  std::vector<Cpv> cpvs;                     // sorted by (cell, interval)
  std::vector<RegionTerm> terms;             // per CPV, by hierarchy rank of the object
  std::vector<std::vector<std::uint32_t>> visible_sets;
  double worst_predicted_ms = 0.0;    // over all leaf regions, in budget or not
  std::vector<std::string> left_out;  // e.g. hot cells not halved, since max_terms or max_cpvs would be passed

  [[nodiscard]] std::span<const RegionTerm> terms_of(const Cpv& cpv) const {
    return std::span(terms).subspan(cpv.first_term, cpv.term_count);
  }
};

struct SubdivisionOptions {
  int threads = 1;
  double predicted_budget_ms = 0.0;  // a region is a CPV when its predicted bound exceeds this
  // Hot cells are no longer halved beyond either; the leaf cubes themselves are always searched in full.
  std::uint64_t max_terms = 20'000'000;  // 16 bytes each, twice while it runs
  std::uint64_t max_cpvs = 1'000'000;
  std::vector<CellKey> leaves;  // these of leaf_keys() alone, sorted: a part of the view space; empty: all
};

/// Visible sets belong to cubes of the leaf level: `visible_sets[i]` to `visible_cells[i]` (sorted); empty: no visibility. Finer cells
/// inherit their leaf's.
struct Visibility {
  std::vector<CellKey> cells;
  std::vector<std::vector<std::uint32_t>> sets;
};

/// The same result for any number of threads, and with or without `memory` of searches at other budgets (which it adds to).
[[nodiscard]] Subdivision subdivide(const Scene& scene, const std::vector<std::uint32_t>& hierarchy_rank, const ViewSpace& view_space,
                                    const Visibility& visibility, const TimeModel& model, const Camera& camera,
                                    const ViewSpaceOptions& options, const SubdivisionOptions& subdivision_options,
                                    const WorkBudget& budget, SearchMemory* memory = nullptr);

/// All leaf-level keys with a non-empty cell box, sorted (what visibility is computed for).
[[nodiscard]] std::vector<CellKey> leaf_keys(const ViewSpace& view_space);

}  // namespace standin
