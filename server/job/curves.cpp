#include "server/job/curves.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <numeric>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/impostor/atlas.h"
#include "render/impostor/texture_pyramid.h"
#include "render/visibility/visible_set.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr std::size_t kRegions = 8;
constexpr std::size_t kLeaves = 4;
constexpr std::size_t kImpostors = 8;

json point(double seconds, double work, double error, const char* unit) {
  return {{"seconds", seconds}, {"work", work}, {"error", error}, {"unit", unit}};
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of two runs the shorter: the first may find cold caches.
template <class Work>
double warm_seconds_of(const Work& work) {
  const double cold = seconds_of(work);
  return std::min(cold, seconds_of(work));
}

/// `count` positions at most, spread evenly over [0, size).
std::vector<std::size_t> spread(std::size_t size, std::size_t count) {
  std::vector<std::size_t> positions;
  const std::size_t taken = std::min(size, count);
  for (std::size_t i = 0; i < taken; ++i) positions.push_back(i * size / taken);
  return positions;
}

/// Cumulative seconds of the last `count` runs.
std::vector<double> last_laps(std::vector<double> laps, std::size_t count) {
  if (laps.size() > count) laps.erase(laps.begin(), laps.end() - static_cast<std::ptrdiff_t>(count));
  return laps;
}

/// Those that hold the cells with the highest bounds, sorted.
std::vector<CellKey> slowest_leaves(const Subdivision& subdivision, int leaf_level) {
  std::map<CellKey, double> worst_ms;
  for (const Cell& cell : subdivision.cells) {
    CellKey leaf = cell.key;
    while (leaf.level > leaf_level) leaf = leaf.parent();
    worst_ms[leaf] = std::max(worst_ms[leaf], cell.worst_predicted_ms);
  }
  std::vector<std::pair<CellKey, double>> order(worst_ms.begin(), worst_ms.end());
  std::ranges::stable_sort(order, std::ranges::greater(), &std::pair<CellKey, double>::second);
  order.resize(std::min(order.size(), kLeaves));
  std::vector<CellKey> leaves;
  for (const auto& [leaf, ms] : order) leaves.push_back(leaf);
  std::ranges::sort(leaves);
  return leaves;
}

/// Texture bytes of an impostor baked with other texels; as it is where that is impossible.
double bytes_at(const World& world, const Impostor& impostor, const TexturePyramids& textures, const BakeQuality& quality,
                const WorkBudget& budget) {
  try {
    return static_cast<double>(
        texture_bytes(bake_layered(world.scene, textures, {impostor.objects, impostor.view_cell}, world.camera, quality, budget)));
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kImpostorImpossible) throw;
    return static_cast<double>(texture_bytes(impostor));
  }
}

}  // namespace

json estimator_curve(const Target& target) {
  json curve = json::array();
  for (const LearningPoint& learned : target.learning_curve)
    curve.push_back(point(learned.seconds, learned.frames, learned.median_error, "median error of the predicted frame time, held out"));
  return curve;
}

json visibility_curve(const World& world, const JobSpec& spec, const WorkBudget& budget) {
  json curve = json::array();
  if (world.visibility.cells.empty()) return curve;
  std::vector<Box> regions;
  for (const auto i : spread(world.visibility.cells.size(), kRegions))
    regions.push_back(world.view_space.cell_box(world.visibility.cells[i]));
  const double scale = static_cast<double>(world.visibility.cells.size()) / static_cast<double>(regions.size());
  for (const double factor : {64.0, 16.0, 4.0, 1.0}) {
    const VisibilityOptions options{spec.visibility_rays, std::min(0.5, factor * spec.visibility_missed_share), spec.seed};
    double bound = 0.0;
    double rays = 0.0;
    const double seconds = warm_seconds_of([&] {
      bound = rays = 0.0;
      for (const auto& set : sample_visible_sets(world.scene, *world.raytracer, regions, options, world.threads, budget)) {
        bound += set.missed_share_bound / static_cast<double>(regions.size());
        rays += static_cast<double>(set.rays) / static_cast<double>(regions.size());
      }
    });
    curve.push_back(point(scale * seconds, rays, bound, "share of rays that may see something new, certified at 99 %"));
  }
  return curve;
}

json view_space_curve(const World& world, const TimeModel& model, const Subdivision& subdivision, double predicted_budget_ms,
                      double worst_sampled_ms, const WorkBudget& budget) {
  constexpr const char* kUnit = "highest bound over worst sampled view, of the slowest leaf cubes";
  json curve = json::array();
  if (!(worst_sampled_ms > 0.0)) return curve;
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = predicted_budget_ms;
  options.leaves = slowest_leaves(subdivision, world.view_space.leaf_level);
  ViewSpace space = world.view_space;
  for (space.finest_level = space.leaf_level; space.finest_level <= world.view_space.finest_level; ++space.finest_level) {
    Subdivision found;
    const double taken = seconds_of([&] {
      found = subdivide(world.scene, world.hierarchy.rank, space, world.visibility, model, world.camera, world.view_space_options, options,
                        budget);
    });
    curve.push_back(point(taken, static_cast<double>(found.cells.size()), found.worst_predicted_ms / worst_sampled_ms, kUnit));
  }
  return curve;
}

json select_curve(const SelectedImpostors& selected) {
  json curve = json::array();
  const double bound_bytes = selected.first_bound_bytes;
  if (!(bound_bytes > 0.0)) return curve;
  for (const auto& [step, seconds] : selected.first_steps) {
    curve.push_back(point(seconds, static_cast<double>(step.gains), (step.bytes - bound_bytes) / step.bytes,
                          "share of the first selection's bytes above the bound behind its prices, after each step"));
    curve.back()["step"] = step.name;
  }
  return curve;
}

json bake_rounds_curve(const SelectedImpostors& selected, const StageClock& clock) {
  json curve = json::array();
  const auto laps = last_laps(clock.laps("bake"), selected.rounds.size());
  double baked = 0.0;
  for (std::size_t i = 0; i < laps.size() && i < selected.rounds.size(); ++i) {
    baked += selected.rounds[i].baked;
    curve.push_back(point(laps[i], baked, selected.rounds[i].real_bytes, "bytes of what is chosen"));
  }
  return curve;
}

json bake_curve(const World& world, std::span<const Impostor> impostors, const WorkBudget& budget) {
  json curve = json::array();
  double all_bytes = 0.0, sample_bytes = 0.0;
  for (const auto& impostor : impostors) all_bytes += static_cast<double>(texture_bytes(impostor));
  std::vector<const Impostor*> sample;
  for (const auto i : spread(impostors.size(), kImpostors)) {
    sample.push_back(&impostors[i]);
    sample_bytes += static_cast<double>(texture_bytes(impostors[i]));
  }
  if (!(sample_bytes > 0.0)) return curve;
  const double scale = all_bytes / sample_bytes;
  const TexturePyramids textures(world.scene);
  for (const double factor : {4.0, 2.0, 1.0}) {
    BakeQuality quality = world.quality;
    quality.texel_scale *= factor;
    std::vector<double> bytes(sample.size());
    const double seconds = warm_seconds_of([&] {
      parallel_for(sample.size(), world.threads, budget,
                   [&](std::size_t i) { bytes[i] = bytes_at(world, *sample[i], textures, quality, budget); });
    });
    curve.push_back(point(scale * seconds, scale * std::accumulate(bytes.begin(), bytes.end(), 0.0), factor * world.quality.texel_scale,
                          "side of a texel in centre pixels"));
  }
  return curve;
}

}  // namespace standin
