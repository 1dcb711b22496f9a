// The time bound of a view space region (3D cell x direction interval), kept per object (thesis 5.2.1, 5.5.2; math.md 4).
//
// Every enclosing region of a region's views is valid, so an object counts only where all of these may see it: the boxes of the cell and of
// its ancestors up to the leaf level of the view space, each paired with the cones of the interval and of all its ancestors up to the whole
// face. Its cost bound is that of the cell's own box (the least over the chain: a smaller box never has a larger one). Child
// regions are therefore never bounded above their parents, object by object.
//
// That cost holds for any direction, cheaply, and is what the search prunes by at first. Of a region of the finest levels that it leaves,
// every object is looked at again, sample by sample (estimation/gaze.h): what of it no view of the region sees costs nothing.
// RegionBounds::kByObject leaves that out; RegionBounds::kByView puts sampled views (region_sample.h) in its place where the search ends.
//
// A bound is loose because eyes are spread over a cell and because they turn within an interval, about alike: so a cell halved in position
// has its intervals halved, too, at its first halving and at every other one after it (halving both each time costs more and gains little,
// tests/bench/region_bound.md).
//
// Pixel work saturates (screen_coverage.h), so a region has two linear bounds: all terms with their pixels, or terms without and as many of
// the costliest pixels as can pass. The smaller is chosen.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/feature_table.h"
#include "estimation/time_model.h"
#include "placement/view_space/view_space.h"
#include "render/view/enclosing_region.h"

namespace standin {

/// 393,216 cones; finer intervals hardly tighten a bound, whose cone is dominated by the field of view.
inline constexpr int kDeepestDirectionLevel = 8;

/// Of the intervals of a cell that lies `halvings` below a leaf cube, whose own are of `level`.
[[nodiscard]] constexpr int direction_level(int level, int halvings) {
  return std::min(level + (halvings + 1) / 2, std::max(level, kDeepestDirectionLevel));
}

/// One object's share of a region's bound, in the region's linear form.
struct RegionTerm {
  std::uint32_t object = 0;
  double predicted_ms = 0.0;
};

/// Cones of all direction nodes down to `deepest_level`, computed once: they depend on the camera alone.
class DirectionTree {
 public:
  DirectionTree(const Camera& camera, int deepest_level);
  [[nodiscard]] const DirectionCone& cone(const DirectionInterval& interval) const;

 private:
  std::vector<DirectionCone> cones_;
};

/// What an object costs at most in any view from a cell.
struct ObjectCost {
  std::uint32_t object = 0;
  Box bounds;
  Cost cost;
};

/// A cell's objects in hierarchy order, those that may cost anything.
struct CellCosts {
  std::vector<Box> chain;  // boxes of the cell and its ancestors, the cell's first
  std::vector<ObjectCost> objects;
  std::vector<std::optional<ObjectFromBox>> samples;  // of `objects`, as far as anybody asked for them
  std::vector<Box> parts;                             // of the view space in the cell, where views are sampled (RegionBounds::kByView)
};

/// Running sums of a region's two linear forms, always added up in hierarchy order.
struct RegionSums {
  double with_pixels_ms = 0.0;
  double capped_ms = 0.0;
  [[nodiscard]] bool pixels_capped() const { return capped_ms < with_pixels_ms; }
  [[nodiscard]] double predicted_ms() const { return pixels_capped() ? capped_ms : with_pixels_ms; }
  void add(const Cost& cost) {
    with_pixels_ms += cost.fixed_ms + cost.pixel_ms;
    capped_ms += cost.fixed_ms;
  }
};

struct RegionBound {
  bool pixels_capped = false;  // the linear form chosen
  double constant_ms = 0.0;    // the frame's own cost, and the most that pixels may cost where capped
  double predicted_ms = 0.0;   // constant_ms plus all terms, summed in term order
  std::vector<RegionTerm> terms;
};

/// All references must outlive it. Const members may be called from several threads.
class RegionEstimator {
 public:
  RegionEstimator(const Scene& scene, const std::vector<std::uint32_t>& hierarchy_rank, const TimeModel& model, const Camera& camera,
                  const ViewSpaceOptions& options);

  /// `visible`: ids of the objects that may be seen from the cell; `parts`: CellBoxes::parts, asked for by RegionBounds::kByView alone
  /// (none given: the cell's whole box).
  [[nodiscard]] CellCosts cell_costs(std::vector<Box> chain, std::span<const std::uint32_t> visible, std::vector<Box> parts = {}) const;
  /// An empty frame in both linear forms.
  [[nodiscard]] RegionSums empty_frame() const;
  [[nodiscard]] bool may_see(const DirectionInterval& interval, const CellCosts& cell, const Box& bounds) const;
  /// The bound of one region from scratch: what subdivide() finds, for a checker. Uses every ancestor of `interval`.
  [[nodiscard]] RegionBound region_bound(CellCosts& cell, const DirectionInterval& interval) const;
  /// Of the finest intervals of a cell: those that are regions with it.
  [[nodiscard]] int leaf_level(const CellCosts& cell) const;
  /// Intervals of this level and finer ones are bounded sample by sample.
  [[nodiscard]] int first_sharp_level(const CellCosts& cell) const { return std::max(0, leaf_level(cell) - kSharpLevels + 1); }
  /// Lowers `costs` (of the objects `seen`: indices into cell.objects, ascending), which hold for an interval that holds this one, to what
  /// holds for this one (or, by views and in a leaf region, sets them to what its sampled views say); up to the end where their sum exceeds
  /// `predicted_ms`, which is returned.
  [[nodiscard]] bool sharpen(CellCosts& cell, const DirectionInterval& interval, std::span<const std::uint32_t> seen, std::span<Cost> costs,
                             double predicted_ms) const;
  [[nodiscard]] RegionBound bound_of(const CellCosts& cell, std::span<const std::uint32_t> seen, std::span<const Cost> costs) const;
  /// Not less than region_bound(), and cheap.
  [[nodiscard]] double coarse_bound_ms(const CellCosts& cell, const DirectionInterval& interval) const;

  [[nodiscard]] bool by_view() const { return bounds_ == RegionBounds::kByView; }
  [[nodiscard]] const FeatureTable& features() const { return features_; }
  [[nodiscard]] const TimeModel& model() const { return *model_; }

 private:
  // A wide interval sees too much to be worth it.
  static constexpr int kSharpLevels = 2;

  [[nodiscard]] std::vector<std::uint32_t> seen_in(const CellCosts& cell, const DirectionInterval& interval) const;
  [[nodiscard]] Cost cost_in(CellCosts& cell, std::uint32_t index, const Gaze& gaze) const;
  [[nodiscard]] RegionSums sums_of(std::span<const Cost> costs) const;
  void sample(const CellCosts& cell, const DirectionInterval& interval, std::span<const std::uint32_t> seen, std::span<Cost> costs) const;

  const Scene* scene_;
  const std::vector<std::uint32_t>* rank_;
  const TimeModel* model_;
  FeatureTable features_;
  int first_leaf_level_;  // of directions, in cells that are not halved
  DirectionTree directions_;
  RegionBounds bounds_;
};

}  // namespace standin
