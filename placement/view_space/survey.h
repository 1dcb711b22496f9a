// How slow is the scene really, view by view: estimates of sampled single views beside the bounds of regions.
//
// A region's bound stands 1.2 to 1.7 times above the worst view in it (tests/bench/region_bound.md names the price), so a survey reports
// both: frame times of views drawn uniformly from the view space and from all directions, and, since the worst frame hides in few places,
// further views drawn from the leaf regions with the highest bounds and climbing there. Their ratio is the first quality figure of a job.
#pragma once

#include <cstdint>
#include <vector>

#include "placement/view_space/subdivision.h"
#include "render/view/camera.h"

namespace standin {

struct SurveyOptions {
  std::uint32_t views = 20'000;         // uniform over view space and sphere
  std::uint32_t hot_regions = 256;      // leaf regions of highest bound, one a cell
  std::uint32_t views_per_region = 96;  // half of them uniform, the others climb from the worst
  std::uint32_t worst_views = 8;        // listed with their causes
  std::uint64_t seed = 1;
  int threads = 1;
};

struct SurveyedView {
  View view;
  std::uint32_t cell = 0;  // of Subdivision::cells
  double predicted_ms = 0.0;
};

/// A slow view and its dearest objects (predicted with their pixels, before the cap), largest first.
struct SlowView {
  SurveyedView surveyed;
  std::vector<RegionTerm> causes;  // at most 8, each as if nothing hid it
};

/// The worst leaf region of a cell: its bound against the worst of the views sampled in it.
struct SurveyedRegion {
  std::uint32_t cell = 0;
  DirectionInterval interval;
  double bound_predicted_ms = 0.0;
  double worst_sampled_ms = 0.0;
  [[nodiscard]] double looseness() const { return worst_sampled_ms > 0.0 ? bound_predicted_ms / worst_sampled_ms : 1.0; }
};

struct Survey {
  std::vector<SurveyedView> uniform;
  std::vector<SurveyedView> hot;  // views_per_region for each region, in the order of `regions`
  std::vector<SurveyedRegion> regions;
  std::vector<SlowView> worst;  // slowest first, of uniform and hot views, one a cell
  double p50_ms = 0.0;          // of the uniform views
  double p90_ms = 0.0;
  double p99_ms = 0.0;
  double worst_frame_ms = 0.0;  // of all views
  double worst_bound_ms = 0.0;  // predicted, over all leaf regions
  double looseness_p50 = 1.0;   // over `regions`
  double looseness_max = 1.0;
};

/// All times are predicted (TimeModel::predicted_ms), not bounds on the measured. The same result for any number of threads.
[[nodiscard]] Survey survey_views(const Scene& scene, const ViewSpace& view_space, const Subdivision& subdivision, const TimeModel& model,
                                  const Camera& camera, const SurveyOptions& options, const WorkBudget& budget);

/// The nearest-rank percentile (share in 0..1) of `values`; 0 when there are none.
[[nodiscard]] double percentile(std::vector<double> values, double share);

}  // namespace standin
