// Environment maps of layers about every cell of a grid (thesis 3.8.2 and 5.8.2, test 15): their bytes, and the time that a walk among them
// takes. table_5_1.mjs sets them against a placement; results: table_5_1.md.
//
//     environment_maps SCENE TARGET.json SIDE_M FAR_FIELD_M,.. [CELLS [VIEWS [MISSED_SHARE]]]
//
// The walkable view space is cut into cells of SIDE_M. From each, the visible objects that lie at least FAR_FIELD_M away are baked into at
// most six layered impostors around the cell, all others stay as they are. So many CELLS, evenly spread, are baked; the bytes of all are
// extrapolated, with the standard error of the sum. A far field of `inf` leaves all as it is. Prints one object of JSON per far field.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "estimation/feature_table.h"
#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/region_bound.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/rng.h"
#include "render/impostor/arrangements.h"
#include "render/impostor/atlas.h"
#include "render/impostor/technique.h"
#include "render/impostor/texture_pyramid.h"
#include "render/scene/object_bounds.h"
#include "render/visibility/visible_set.h"
#include "server/job/surveyed_scene.h"

namespace standin {
namespace {

constexpr std::uint32_t kAnyLayers = 100'000;  // maps are all or nothing: no cap

/// One cell with its maps.
struct MappedCell {
  Box box;
  std::vector<Box> chain;
  std::vector<std::uint32_t> near;  // stay as they are
  std::vector<Impostor> maps;
  std::vector<Box> map_bounds;
  double bytes = 0.0;
};

struct WalkTimes {
  double mean_ms = 0.0;    // predicted
  double worst_ms = 0.0;   // predicted
  double region_ms = 0.0;  // greatest predicted bound of a region
};

class Bench {
 public:
  Bench(const Surveyed& job, std::uint32_t views)
      : job_(job),
        world_(job.world),
        views_(views),
        cells_(job.world.view_space),
        table_(world_.scene, world_.camera),
        estimator_(world_.scene, world_.hierarchy.rank, job.target.model, world_.camera, world_.view_space_options),
        textures_(world_.scene) {}

  [[nodiscard]] std::size_t cell_count() const { return cells_.leaves().size(); }

  /// Evenly spread, with what is visible from each.
  void choose_cells(std::size_t count, const VisibilityOptions& options) {
    const std::size_t taken = std::min(count, cell_count());
    for (std::size_t i = 0; i < taken; ++i) chosen_.push_back(cells_.leaves()[(2 * i + 1) * cell_count() / (2 * taken)]);
    std::vector<Box> boxes;
    for (const CellKey& key : chosen_) boxes.push_back(cells_.cell_box(key));
    for (auto& set : sample_visible_sets(world_.scene, *world_.raytracer, boxes, options, world_.threads, {}))
      visible_.push_back(std::move(set.objects));
  }

  [[nodiscard]] nlohmann::json measure(double far_field_m) const {
    std::vector<double> bytes(chosen_.size());
    std::vector<WalkTimes> times(chosen_.size());
    parallel_for(chosen_.size(), world_.threads, {}, [&](std::size_t i) {
      const MappedCell cell = bake(i, far_field_m);
      bytes[i] = cell.bytes;
      times[i] = walk(cell, Rng(1, i));
    });
    return summary(far_field_m, bytes, times);
  }

 private:
  [[nodiscard]] MappedCell bake(std::size_t i, double far_field_m) const {
    MappedCell cell{cells_.cell_box(chosen_[i]), cells_.chain(chosen_[i]), visible_[i], {}, {}, 0.0};
    BakeQuality quality = world_.quality;
    quality.max_layers = kAnyLayers;
    for (const BakeRequest& request : environment_map_requests(world_.scene, visible_[i], cell.box, far_field_m)) {
      std::erase_if(cell.near, [&](std::uint32_t id) { return std::ranges::binary_search(request.objects, id); });
      cell.maps.push_back(bake_impostor(world_.scene, textures_, Technique::kLayered, request, world_.camera, quality));
      cell.map_bounds.push_back(bounds_of(world_.scene, request.objects));
      cell.bytes += static_cast<double>(texture_bytes(cell.maps.back()));
    }
    return cell;
  }

  [[nodiscard]] WalkTimes walk(const MappedCell& cell, Rng rng) const {
    WalkTimes times;
    for (std::uint32_t v = 0; v < views_; ++v) {
      const double time_ms = predicted_ms(cell, level_view(cell.box, rng));
      times.mean_ms += time_ms / views_;
      times.worst_ms = std::max(times.worst_ms, time_ms);
    }
    times.region_ms = worst_region_ms(cell);
    return times;
  }

  /// Of somebody who looks straight ahead.
  static View level_view(const Box& box, Rng& rng) {
    View view;
    for (int axis = 0; axis < 3; ++axis) view.position[axis] = rng.uniform(box.min[axis], box.max[axis]);
    const double azimuth = rng.uniform(0.0, 2.0 * std::numbers::pi);
    view.direction = {std::cos(azimuth), 0.0, std::sin(azimuth)};
    return view;
  }

  [[nodiscard]] double predicted_ms(const MappedCell& cell, const View& view) const {
    Features frame = table_.frame(cell.near, view);
    for (std::size_t m = 0; m < cell.maps.size(); ++m) frame += impostor_features(cell.maps[m], cell.map_bounds[m], view, world_.camera);
    return job_.target.model.predicted_ms(frame);
  }

  /// Greatest bound over all leaf intervals: the near objects', and of each map that some view of the region may see.
  [[nodiscard]] double worst_region_ms(const MappedCell& cell) const {
    CellCosts costs = estimator_.cell_costs(cell.chain, cell.near);
    const int level = estimator_.leaf_level(costs);
    double worst_ms = 0.0;
    for (int face = 0; face < kFaceCount; ++face)
      for (int i = 0; i < 1 << level; ++i)
        for (int j = 0; j < 1 << level; ++j) {
          const DirectionInterval interval{static_cast<Face>(face), level, i, j};
          const Cost maps = seen_maps(cell, costs, interval);
          if (estimator_.coarse_bound_ms(costs, interval) + maps.fixed_ms + maps.pixel_ms <= worst_ms) continue;
          const RegionBound bound = estimator_.region_bound(costs, interval);
          worst_ms = std::max(worst_ms, bound.predicted_ms + maps.fixed_ms + (bound.pixels_capped ? 0.0 : maps.pixel_ms));
        }
    return worst_ms;
  }

  [[nodiscard]] Cost seen_maps(const MappedCell& cell, const CellCosts& costs, const DirectionInterval& interval) const {
    Cost sum;
    for (std::size_t m = 0; m < cell.maps.size(); ++m) {
      if (!estimator_.may_see(interval, costs, cell.map_bounds[m])) continue;
      const Cost cost = job_.target.model.cost(impostor_features_bound(impostor_cost(cell.maps[m]), world_.camera));
      sum.fixed_ms += cost.fixed_ms;
      sum.pixel_ms += cost.pixel_ms;
    }
    return sum;
  }

  [[nodiscard]] nlohmann::json summary(double far_field_m, const std::vector<double>& bytes, const std::vector<WalkTimes>& times) const {
    const auto n = static_cast<double>(bytes.size());
    double mean = 0.0, variance = 0.0;
    for (const double b : bytes) mean += b / n;
    for (const double b : bytes) variance += (b - mean) * (b - mean) / std::max(1.0, n - 1.0);
    WalkTimes all;
    for (const WalkTimes& one : times) {
      all.mean_ms += one.mean_ms / n;
      all.worst_ms = std::max(all.worst_ms, one.worst_ms);
      all.region_ms = std::max(all.region_ms, one.region_ms);
    }
    const auto cells = static_cast<double>(cell_count());
    const TimeModel& model = job_.target.model;
    return {{"side_m", world_.view_space_options.leaf_m},
            {"far_field_m", far_field_m},
            {"cells", cell_count()},
            {"sampled", bytes.size()},
            {"bytes", cells * mean},
            {"bytes_standard_error", cells * std::sqrt(variance / n)},
            {"walk_mean_ms", all.mean_ms},
            {"walk_worst_ms", all.worst_ms},
            {"walk_worst_bound_ms", model.bound_ms(all.worst_ms)},
            {"region_bound_ms", model.bound_ms(all.region_ms)}};
  }

  const Surveyed& job_;
  const World& world_;
  std::uint32_t views_;
  CellBoxes cells_;
  FeatureTable table_;
  RegionEstimator estimator_;
  TexturePyramids textures_;
  std::vector<CellKey> chosen_;
  std::vector<std::vector<std::uint32_t>> visible_;
};

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  using namespace standin;
  if (argc < 5)
    return std::fprintf(stderr, "usage: environment_maps SCENE TARGET SIDE_M FAR_FIELD_M,.. [CELLS [VIEWS [MISSED_SHARE]]]\n"), 2;
  try {
    JobSpec spec;
    spec.lods = "off";  // objects as the scene has them
    spec.view_space = "walk";
    spec.leaf_m = std::strtod(argv[3], nullptr);
    spec.visibility = "off";  // of the chosen cells alone, below
    const WorkBudget budget;
    StageClock clock(budget);
    Surveyed job;
    load_job({argv[1], argv[2], {}}, spec, clock, budget, job);
    Bench bench(job, static_cast<std::uint32_t>(argc > 6 ? std::strtoul(argv[6], nullptr, 10) : 64));
    const double missed_share = argc > 7 ? std::strtod(argv[7], nullptr) : spec.visibility_missed_share;
    bench.choose_cells(argc > 5 ? std::strtoul(argv[5], nullptr, 10) : 24, {spec.visibility_rays, missed_share, spec.seed});
    std::istringstream far_fields(argv[4]);
    for (std::string far_field; std::getline(far_fields, far_field, ',');) {
      std::printf("%s\n", bench.measure(std::stod(far_field)).dump().c_str());
      std::fflush(stdout);
    }
  } catch (const Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 2;
  }
}
