// Problem view space approximation (thesis 5.5): the regions (3D cell x direction interval) whose time bound exceeds the budget.
//
// A region's bound is kept per object: the object's cost bound over the leaf (nearest distance between the cell's box and the object's
// bounds), counted only where the leaf *and all its ancestors* may see it (each is valid for all views inside; math.md 4). Of the two
// linear forms (sum of pixel costs, or a constant cap and no pixel costs) the smaller is chosen per region, before selection, and stays.
// Hot leaves are halved further in position, each sub-leaf a cell of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "estimation/time_model.h"
#include "placement/view_space/view_space.h"
#include "render/base/work.h"
#include "render/view/direction_interval.h"
#include "render/view/enclosing_region.h"

namespace standin {

/// Leaf of the 3D subdivision.
struct Cell {
  CellKey key;
  Box box;
  std::int32_t visible_set = -1;  // index into Subdivision::visible_sets; -1: everything may be visible
};

/// One object's share of a region's bound, in the region's linear form.
struct RegionTerm {
  std::uint32_t object = 0;
  double predicted_ms = 0.0;
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
  double worst_predicted_ms = 0.0;  // over all leaf regions, in budget or not
};

struct SubdivisionOptions {
  int threads = 1;
  double predicted_budget_ms = 0.0;  // a region is a CPV when its predicted bound exceeds this
};

/// Visible sets belong to cubes of the leaf level: `visible_sets[i]` to `visible_cells[i]` (sorted); empty: no visibility. A coarser cell
/// uses the union.
struct Visibility {
  std::vector<CellKey> cells;
  std::vector<std::vector<std::uint32_t>> sets;
};

[[nodiscard]] Subdivision subdivide(const Scene& scene, const std::vector<std::uint32_t>& hierarchy_rank, const ViewSpace& view_space,
                                    const Visibility& visibility, const TimeModel& model, const Camera& camera,
                                    const ViewSpaceOptions& options, const SubdivisionOptions& subdivision_options,
                                    const WorkBudget& budget);

/// All leaf-level keys with a non-empty cell box, sorted (what visibility is computed for).
[[nodiscard]] std::vector<CellKey> leaf_keys(const ViewSpace& view_space);

}  // namespace standin
