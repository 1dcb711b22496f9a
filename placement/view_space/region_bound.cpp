#include "placement/view_space/region_bound.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "placement/view_space/region_sample.h"
#include "render/base/error.h"

namespace standin {
namespace {

// Sums in another order may differ by less, relatively.
constexpr double kRounding = 1e-9;

// Nodes of all levels before `level` on all faces: 6 (1 + 4 + .. + 4^(level-1)).
std::size_t nodes_above(int level) {
  return kFaceCount * (((std::size_t{1} << (2 * level)) - 1) / 3);
}

std::size_t node_number(const DirectionInterval& interval) {
  const auto side = std::size_t{1} << interval.level;
  return nodes_above(interval.level) + (static_cast<std::size_t>(interval.face) * side + static_cast<std::size_t>(interval.i)) * side +
         static_cast<std::size_t>(interval.j);
}

}  // namespace

DirectionTree::DirectionTree(const Camera& camera, int deepest_level) {
  if (deepest_level < 0 || deepest_level > kDeepestDirectionLevel)
    throw Failure(ErrorWord::kBadUsage, "direction intervals: level " + std::to_string(deepest_level) + " is not in 0.." +
                                            std::to_string(kDeepestDirectionLevel) + " (90 to 0.35 degrees)");
  cones_.reserve(nodes_above(deepest_level + 1));
  for (int level = 0; level <= deepest_level; ++level)
    for (int face = 0; face < kFaceCount; ++face)
      for (int i = 0; i < 1 << level; ++i)
        for (int j = 0; j < 1 << level; ++j) cones_.push_back(enclosing_cone({static_cast<Face>(face), level, i, j}, camera));
}

const DirectionCone& DirectionTree::cone(const DirectionInterval& interval) const {
  return cones_[node_number(interval)];
}

RegionEstimator::RegionEstimator(const Scene& scene, const std::vector<std::uint32_t>& hierarchy_rank, const TimeModel& model,
                                 const Camera& camera, const ViewSpaceOptions& options)
    : scene_(&scene),
      rank_(&hierarchy_rank),
      model_(&model),
      features_(scene, camera),
      first_leaf_level_(level_for_width(options.interval_deg)),
      directions_(camera, direction_level(first_leaf_level_, options.refine_levels)),
      bounds_(options.bounds) {}

int RegionEstimator::leaf_level(const CellCosts& cell) const {
  return direction_level(first_leaf_level_, static_cast<int>(cell.chain.size()) - 1);
}

CellCosts RegionEstimator::cell_costs(std::vector<Box> chain, std::span<const std::uint32_t> visible, std::vector<Box> parts) const {
  CellCosts cell;
  cell.chain = std::move(chain);
  cell.parts = parts.empty() ? std::vector<Box>{cell.chain.front()} : std::move(parts);
  cell.objects.reserve(visible.size());
  for (const std::uint32_t object : visible) {
    const Box& bounds = scene_->objects[object].bounds;
    if (bounds.empty()) continue;
    const Cost cost = model_->cost(features_.bound(object, cell.chain.front()));
    if (cost.fixed_ms > 0.0 || cost.pixel_ms > 0.0) cell.objects.push_back({object, bounds, cost});
  }
  std::sort(cell.objects.begin(), cell.objects.end(),
            [this](const ObjectCost& a, const ObjectCost& b) { return (*rank_)[a.object] < (*rank_)[b.object]; });
  cell.samples.resize(cell.objects.size());
  return cell;
}

RegionSums RegionEstimator::empty_frame() const {
  RegionSums sums;
  sums.add(model_->cost(frame_features()));
  sums.capped_ms += model_->most_pixel_ms(features_.pixel_terms(), features_.most_passed_pixels());
  return sums;
}

bool RegionEstimator::may_see(const DirectionInterval& interval, const CellCosts& cell, const Box& bounds) const {
  const DirectionCone& cone = directions_.cone(interval);
  return std::all_of(cell.chain.begin(), cell.chain.end(), [&](const Box& box) { return standin::may_see(cone, box, bounds); });
}

std::vector<std::uint32_t> RegionEstimator::seen_in(const CellCosts& cell, const DirectionInterval& interval) const {
  const auto seen_by_all = [&](const Box& bounds) {
    for (DirectionInterval node = interval; node.level >= 0; node = node.parent())
      if (!may_see(node, cell, bounds)) return false;
    return true;
  };
  std::vector<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < cell.objects.size(); ++i)
    if (seen_by_all(cell.objects[i].bounds)) seen.push_back(i);
  return seen;
}

double RegionEstimator::coarse_bound_ms(const CellCosts& cell, const DirectionInterval& interval) const {
  RegionSums sums = empty_frame();
  for (const std::uint32_t i : seen_in(cell, interval)) sums.add(cell.objects[i].cost);
  return sums.predicted_ms();
}

RegionBound RegionEstimator::region_bound(CellCosts& cell, const DirectionInterval& interval) const {
  const std::vector<std::uint32_t> seen = seen_in(cell, interval);
  std::vector<Cost> costs;
  for (const std::uint32_t i : seen) costs.push_back(cell.objects[i].cost);
  std::vector<DirectionInterval> chain;
  for (DirectionInterval node = interval; node.level >= first_sharp_level(cell); node = node.parent()) chain.push_back(node);
  std::ranges::reverse(chain);
  for (const DirectionInterval& node : chain) (void)sharpen(cell, node, seen, costs, -std::numeric_limits<double>::infinity());
  return bound_of(cell, seen, costs);
}

Cost RegionEstimator::cost_in(CellCosts& cell, std::uint32_t index, const Gaze& gaze) const {
  auto& samples = cell.samples[index];
  if (!samples) samples = features_.from_box(cell.objects[index].object, {cell.chain.front(), cell.chain.back()});
  return model_->cost(features_.bound(*samples, gaze));
}

RegionBound RegionEstimator::bound_of(const CellCosts& cell, std::span<const std::uint32_t> seen, std::span<const Cost> costs) const {
  const RegionSums sums = sums_of(costs);
  RegionBound bound;
  bound.pixels_capped = sums.pixels_capped();
  bound.constant_ms = bound.pixels_capped ? empty_frame().capped_ms : empty_frame().with_pixels_ms;
  bound.predicted_ms = sums.predicted_ms();
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double predicted_ms = bound.pixels_capped ? costs[k].fixed_ms : costs[k].fixed_ms + costs[k].pixel_ms;
    if (predicted_ms > 0.0) bound.terms.push_back({cell.objects[seen[k]].object, predicted_ms});
  }
  return bound;
}

RegionSums RegionEstimator::sums_of(std::span<const Cost> costs) const {
  RegionSums sums = empty_frame();
  for (const Cost& cost : costs) sums.add(cost);
  return sums;
}

// Its generator depends on the interval alone, so that whoever asks of a region finds the same.
void RegionEstimator::sample(const CellCosts& cell, const DirectionInterval& interval, std::span<const std::uint32_t> seen,
                             std::span<Cost> costs) const {
  std::vector<std::uint32_t> objects;
  for (const std::uint32_t i : seen) objects.push_back(cell.objects[i].object);
  const RegionViews views(cell.parts, interval, Rng(1, node_number(interval)));
  cost_by_views(features_, *model_, views, objects, levels_from(*scene_, objects, cell.chain.front()), empty_frame().with_pixels_ms,
                sums_of(costs).predicted_ms(), costs);
}

// The dearest objects are looked at first: a few near ones mostly decide.
bool RegionEstimator::sharpen(CellCosts& cell, const DirectionInterval& interval, std::span<const std::uint32_t> seen,
                              std::span<Cost> costs, double predicted_ms) const {
  if (by_view() && interval.level == leaf_level(cell)) {
    sample(cell, interval, seen, costs);
    return sums_of(costs).predicted_ms() > predicted_ms;
  }
  RegionSums sums = sums_of(costs);
  if (bounds_ == RegionBounds::kByObject) return sums.predicted_ms() > predicted_ms;
  std::vector<std::uint32_t> dearest(seen.size());
  std::iota(dearest.begin(), dearest.end(), 0U);
  std::ranges::stable_sort(dearest, std::ranges::greater(), [&](std::uint32_t k) { return costs[k].fixed_ms + costs[k].pixel_ms; });
  const Gaze gaze(directions_.cone(interval), cell.chain.front(), features_.camera());
  for (const std::uint32_t k : dearest) {
    if (sums.predicted_ms() <= (1.0 - kRounding) * predicted_ms) return false;
    const Cost sharp = cost_in(cell, seen[k], gaze);
    const Cost lower{std::min(sharp.fixed_ms, costs[k].fixed_ms), std::min(sharp.pixel_ms, costs[k].pixel_ms)};
    sums.add({lower.fixed_ms - costs[k].fixed_ms, lower.pixel_ms - costs[k].pixel_ms});
    costs[k] = lower;
  }
  return sums_of(costs).predicted_ms() > predicted_ms;
}

}  // namespace standin
