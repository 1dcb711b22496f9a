// Why a region's bound stands above the worst view in it, of a job's problem regions. Results: region_bound.md.
//
//   region_bound SCENE TARGET BUDGET_MS [REFINE_LEVELS [REGIONS [VIEWS]]]
//
// Three ratios whose product is the looseness: each object's bound over the dearest that it is seen at (the bound's own doing), the sum of
// these over the dearest view taken alone (no view has all objects at their dearest), and that view's objects over the frame in which they
// hide each other.
#include "placement/view_space/region_bound.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/region_views.h"
#include "placement/view_space/subdivision.h"
#include "render/base/parallel.h"
#include "server/job/world.h"

namespace {

using namespace standin;

struct Ratios {
  double looseness = 0.0;
  double bounds = 0.0;  // of objects, over the dearest of each
  double sum = 0.0;     // of the dearest, over the dearest view's
  double hiding = 0.0;  // the dearest view's objects, over the frame
};

class Bench {
 public:
  Bench(const World& world, const TimeModel& model, const Subdivision& subdivision, std::uint32_t views)
      : subdivision_(subdivision),
        model_(model),
        views_(views),
        cells_(world.view_space),
        estimator_(world.scene, world.hierarchy.rank, model, world.camera, world.view_space_options) {}

  [[nodiscard]] Ratios measure(std::size_t p) const {
    const Cpv& cpv = subdivision_.cpvs[p];
    std::vector<std::uint32_t> objects;
    for (const RegionTerm& term : subdivision_.terms_of(cpv)) objects.push_back(term.object);
    std::vector<Cost> dearest(objects.size());
    double dearest_view_ms = 0.0, worst_ms = 0.0;
    RegionViews region(cells_.parts(subdivision_.cells[cpv.cell].key), subdivision_.intervals[cpv.interval], Rng(1, p));
    for (std::uint32_t v = 0; v < views_; ++v) {
      const View view = region.view(region.draw());
      dearest_view_ms = std::max(dearest_view_ms, add_view(view, objects, dearest));
      worst_ms = std::max(worst_ms, model_.predicted_ms(estimator_.features().frame(objects, view)));
    }
    RegionSums sums = estimator_.empty_frame();
    for (const Cost& cost : dearest) sums.add(cost);
    const double sum_ms = sums.predicted_ms();
    return {cpv.predicted_ms / worst_ms, cpv.predicted_ms / sum_ms, sum_ms / dearest_view_ms, dearest_view_ms / worst_ms};
  }

 private:
  /// Milliseconds of the objects of one view, as if none hid another; `dearest` becomes the greatest of each so far.
  [[nodiscard]] double add_view(const View& view, const std::vector<std::uint32_t>& objects, std::vector<Cost>& dearest) const {
    const PreparedView prepared(view, estimator_.features().camera());
    RegionSums sums = estimator_.empty_frame();
    for (std::size_t k = 0; k < objects.size(); ++k) {
      const Cost cost = model_.cost(estimator_.features().estimate(objects[k], prepared));
      sums.add(cost);
      dearest[k] = {std::max(dearest[k].fixed_ms, cost.fixed_ms), std::max(dearest[k].pixel_ms, cost.pixel_ms)};
    }
    return sums.predicted_ms();
  }

  const Subdivision& subdivision_;
  const TimeModel& model_;
  std::uint32_t views_;
  CellBoxes cells_;
  RegionEstimator estimator_;
};

void print(const char* name, const std::vector<Ratios>& found, double Ratios::*ratio) {
  std::vector<double> values;
  for (const Ratios& one : found) values.push_back(one.*ratio);
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) { return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]; };
  std::printf("| %s | %.2f | %.2f | %.2f |\n", name, at(0.1), at(0.5), at(0.9));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fprintf(stderr, "usage: region_bound SCENE TARGET BUDGET_MS [REFINE_LEVELS [REGIONS [VIEWS]]]\n"), 2;
  JobSpec spec;
  spec.lods = "off";
  if (argc > 4) spec.refine_levels = std::atoi(argv[4]);
  const std::size_t wanted = argc > 5 ? std::strtoul(argv[5], nullptr, 10) : 200;
  const auto views = static_cast<std::uint32_t>(argc > 6 ? std::strtoul(argv[6], nullptr, 10) : 400);
  const WorkBudget budget;
  StageClock clock(budget);
  World world;
  build_world(argv[1], spec, clock, budget, world);
  const TimeModel model = read_target(argv[2]).model;
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = model.predicted_budget_ms(std::atof(argv[3]));
  const Subdivision subdivision = subdivide(world.scene, world.hierarchy.rank, world.view_space, world.visibility, model, world.camera,
                                            world.view_space_options, options, budget);
  const std::size_t regions = std::min(wanted, subdivision.cpvs.size());
  if (regions == 0) return std::fprintf(stderr, "region_bound: no region is over %s ms\n", argv[3]), 1;
  std::vector<Ratios> found(regions);
  const Bench bench(world, model, subdivision, views);
  parallel_for(regions, world.threads, budget, [&](std::size_t i) { found[i] = bench.measure(i * subdivision.cpvs.size() / regions); });
  std::printf("%zu of %zu problem regions, %u views each\n\n| | p10 | median | p90 |\n|---|---|---|---|\n", regions,
              subdivision.cpvs.size(), views);
  print("bound over the worst view", found, &Ratios::looseness);
  print("objects' bounds over the dearest of each", found, &Ratios::bounds);
  print("the dearest of each over the dearest view", found, &Ratios::sum);
  print("the dearest view over its frame", found, &Ratios::hiding);
}
