// How loose the bound on a region (3D cell x direction interval) is: over the worst of many views sampled inside it, with and without
// visible sets. Results: region_bound.md.
//
//   region_bound SCENE TARGET [REGIONS [VIEWS [TEXTURE_FOLDER]]]
#include "placement/view_space/region_bound.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "estimation/feature_table.h"
#include "placement/view_space/cell_boxes.h"
#include "render/base/parallel.h"
#include "server/job/world.h"

namespace {

using namespace standin;

constexpr double kLeastFrame_ms = 1.0;

struct Region {
  CellKey cell;
  std::size_t visible_set = 0;
  DirectionInterval interval;
};

struct Looseness {
  double all = 0.0;      // every object may be seen
  double visible = 0.0;  // of the visible set alone; 0: nothing to see
};

class Bench {
 public:
  Bench(const World& world, const TimeModel& model, std::uint32_t views)
      : world_(world),
        model_(model),
        views_(views),
        cells_(world.view_space),
        estimator_(world.scene, world.hierarchy.rank, model, world.camera, world.view_space_options) {
    everything_.resize(world.scene.objects.size());
    std::iota(everything_.begin(), everything_.end(), 0U);
  }

  [[nodiscard]] Region random_region(Rng& rng) const {
    const std::size_t cell = rng.below(cells_.leaves().size());
    const double y = rng.uniform(-0.5, 0.5), azimuth = rng.uniform(0.0, 6.283185307179586);  // as people look
    const Vec3 direction(std::sqrt(1.0 - y * y) * std::cos(azimuth), y, std::sqrt(1.0 - y * y) * std::sin(azimuth));
    return {cells_.leaves()[cell], cell, interval_of(direction, level_for_width(world_.view_space_options.interval_deg))};
  }

  [[nodiscard]] Looseness measure(const Region& region, Rng& rng) const {
    const auto& sets = world_.visibility.sets;
    return {looseness(region, everything_, rng), sets.empty() ? 0.0 : looseness(region, sets[region.visible_set], rng)};
  }

 private:
  [[nodiscard]] double looseness(const Region& region, std::span<const std::uint32_t> objects, Rng& rng) const {
    CellCosts costs = estimator_.cell_costs(cells_.chain(region.cell), objects);
    const double bound_ms = estimator_.region_bound(costs, region.interval).predicted_ms;
    const std::vector<Box> parts = cells_.parts(region.cell);
    const std::vector<double> sums = volume_sums(parts);
    const auto [a0, a1, b0, b1] = region.interval.angles_rad();
    double worst_ms = 0.0;
    for (std::uint32_t i = 0; i < views_; ++i) {
      const double a = rng.uniform(a0, a1);
      const View view{sample_boxes(parts, sums, rng), direction_at(region.interval.face, a, rng.uniform(b0, b1))};
      worst_ms = std::max(worst_ms, model_.predicted_ms(estimator_.features().frame(objects, view)));
    }
    return worst_ms >= kLeastFrame_ms ? bound_ms / worst_ms : 0.0;
  }

  const World& world_;
  const TimeModel& model_;
  std::uint32_t views_;
  CellBoxes cells_;
  RegionEstimator estimator_;
  std::vector<std::uint32_t> everything_;
};

void print(const char* name, std::vector<double> values) {
  std::erase(values, 0.0);
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) { return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]; };
  std::printf("| %s | %zu | %.2f | %.2f | %.2f |\n", name, values.size(), at(0.5), at(0.9), at(0.99));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: region_bound SCENE TARGET [REGIONS [VIEWS [TEXTURE_FOLDER]]]\n"), 2;
  const std::size_t regions = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 300;
  const auto views = static_cast<std::uint32_t>(argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 200);
  JobSpec spec;
  spec.lods = "off";  // objects as the scene has them
  if (argc > 5) spec.texture_folders = {argv[5]};
  spec.visibility = "on";
  const WorkBudget budget;
  StageClock clock(budget);
  World world;
  build_world(argv[1], spec, clock, budget, world);
  const TimeModel model = read_target(argv[2]).model;
  const Bench bench(world, model, views);
  std::vector<Looseness> found(regions);
  parallel_for(regions, world.threads, budget, [&](std::size_t i) {
    Rng rng(spec.seed, i);
    found[i] = bench.measure(bench.random_region(rng), rng);
  });
  std::vector<double> all, visible;
  for (const Looseness& one : found) {
    all.push_back(one.all);
    visible.push_back(one.visible);
  }
  std::printf("| bound over the worst of %u views | regions | median | p90 | p99 |\n|---|---|---|---|---|\n", views);
  print("every object", all);
  print("visible sets", visible);
}
