#include "placement/view_space/survey.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "estimation/feature_table.h"
#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/cell_locator.h"
#include "placement/view_space/region_views.h"
#include "render/base/error.h"
#include "render/base/parallel.h"

namespace standin {
namespace {

constexpr std::size_t kMostCauses = 8;
constexpr std::size_t kViewsPerTask = 64;
constexpr std::size_t kViewsPerCheck = 100'000;
// Streams of the generator: views of the two kinds never share one.
constexpr std::uint64_t kUniformStream = 0;
constexpr std::uint64_t kHotStream = std::uint64_t{1} << 40;

Vec3 uniform_direction(Rng& rng) {
  const double y = rng.uniform(-1.0, 1.0);
  const double azimuth = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(std::max(0.0, 1.0 - y * y));
  return glm::normalize(Vec3(radius * std::cos(azimuth), y, radius * std::sin(azimuth)));
}

/// Room for so many views. Memory of millions takes seconds, in which a job may be told to stop.
std::vector<SurveyedView> unsampled_views(std::size_t count, const WorkBudget& budget) {
  std::vector<SurveyedView> views;
  views.reserve(count);
  while (views.size() < count) {
    budget.check();
    views.resize(std::min(count, views.size() + kViewsPerCheck));
  }
  return views;
}

CellLocator locate_cells(const ViewSpace& space, const Subdivision& subdivision) {
  std::vector<CellKey> keys;
  std::vector<Box> boxes;
  for (const Cell& cell : subdivision.cells) {
    keys.push_back(cell.key);
    boxes.push_back(cell.box);
  }
  return {space.grid(), keys, boxes};
}

class Surveyor {
 public:
  Surveyor(const Scene& scene, const ViewSpace& space, const Subdivision& subdivision, const TimeModel& model, const Camera& camera,
           const SurveyOptions& options, const WorkBudget& budget)
      : scene_(scene),
        space_(space),
        subdivision_(subdivision),
        model_(model),
        camera_(camera),
        options_(options),
        budget_(budget),
        features_(scene, camera),
        cell_boxes_(space),
        locator_(locate_cells(space, subdivision)),
        all_objects_(scene.objects.size()) {
    std::iota(all_objects_.begin(), all_objects_.end(), 0U);
  }

  Survey run() {
    Survey survey;
    survey.worst_bound_ms = subdivision_.worst_predicted_ms;
    survey.uniform = uniform_views();
    survey.regions = hottest_regions();
    survey.hot = hot_views(survey.regions);
    summarise(survey);
    survey.worst = worst_views(survey);
    return survey;
  }

 private:
  [[nodiscard]] const std::vector<std::uint32_t>& visible_from(std::uint32_t cell) const {
    const std::int32_t set = subdivision_.cells[cell].visible_set;
    return set < 0 ? all_objects_ : subdivision_.visible_sets[static_cast<std::size_t>(set)];
  }

  [[nodiscard]] double predict(const View& view, std::uint32_t cell) const {
    const auto& objects = visible_from(cell);
    return model_.predicted_ms(features_.frame(objects, view, levels_from(scene_, objects, subdivision_.cells[cell].box)));
  }

  [[nodiscard]] SurveyedView survey_view(const View& view, std::uint32_t cell) const { return {view, cell, predict(view, cell)}; }

  [[nodiscard]] std::vector<SurveyedView> uniform_views() const {
    std::vector<SurveyedView> views = unsampled_views(options_.views, budget_);
    parallel_for((views.size() + kViewsPerTask - 1) / kViewsPerTask, options_.threads, budget_, [&](std::size_t task) {
      for (std::size_t i = task * kViewsPerTask; i < std::min(views.size(), (task + 1) * kViewsPerTask); ++i) {
        Rng rng(options_.seed, kUniformStream + i);
        const Vec3 position = space_.sample_position(rng);
        const auto cell = locator_.find(position);
        if (!cell) throw Failure(ErrorWord::kInternal, "survey: a position of the view space lies in no cell");
        views[i] = survey_view({position, uniform_direction(rng)}, *cell);
      }
    });
    return views;
  }

  [[nodiscard]] std::vector<SurveyedRegion> hottest_regions() const {
    std::vector<std::uint32_t> order(subdivision_.cells.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      return subdivision_.cells[a].worst_predicted_ms > subdivision_.cells[b].worst_predicted_ms;
    });
    order.resize(std::min<std::size_t>(order.size(), options_.hot_regions));
    std::vector<SurveyedRegion> regions;
    for (const std::uint32_t cell : order)
      regions.push_back({cell, subdivision_.cells[cell].worst_interval, subdivision_.cells[cell].worst_predicted_ms, 0.0});
    return regions;
  }

  [[nodiscard]] std::vector<SurveyedView> hot_views(std::vector<SurveyedRegion>& regions) const {
    const std::size_t each = options_.views_per_region;
    std::vector<SurveyedView> views(regions.size() * each);
    parallel_for(regions.size(), options_.threads, budget_, [&](std::size_t r) {
      SurveyedRegion& region = regions[r];
      const Rng rng(options_.seed, kHotStream + r);
      std::size_t next = r * each;
      climb_to_worst({cell_boxes_.parts(subdivision_.cells[region.cell].key), region.interval, rng}, options_.views_per_region,
                     [&](const View& view) {
                       views[next] = survey_view(view, region.cell);
                       region.worst_sampled_ms = std::max(region.worst_sampled_ms, views[next].predicted_ms);
                       return views[next++].predicted_ms;
                     });
    });
    return views;
  }

  static void summarise(Survey& survey) {
    std::vector<double> times, looseness;
    for (const SurveyedView& view : survey.uniform) times.push_back(view.predicted_ms);
    for (const SurveyedRegion& region : survey.regions) looseness.push_back(region.looseness());
    survey.p50_ms = percentile(times, 0.5);
    survey.p90_ms = percentile(times, 0.9);
    survey.p99_ms = percentile(times, 0.99);
    survey.looseness_p50 = percentile(looseness, 0.5);
    survey.looseness_max = percentile(looseness, 1.0);
    survey.worst_frame_ms = percentile(times, 1.0);
    for (const SurveyedView& view : survey.hot) survey.worst_frame_ms = std::max(survey.worst_frame_ms, view.predicted_ms);
  }

  [[nodiscard]] std::vector<SlowView> worst_views(const Survey& survey) const {
    std::vector<const SurveyedView*> order;
    for (const SurveyedView& view : survey.uniform) order.push_back(&view);
    for (const SurveyedView& view : survey.hot) order.push_back(&view);
    std::stable_sort(order.begin(), order.end(),
                     [](const SurveyedView* a, const SurveyedView* b) { return a->predicted_ms > b->predicted_ms; });
    std::vector<SlowView> worst;
    for (const SurveyedView* view : order) {
      if (worst.size() >= options_.worst_views) break;
      const auto same_cell = [&](const SlowView& listed) { return listed.surveyed.cell == view->cell; };
      if (std::none_of(worst.begin(), worst.end(), same_cell)) worst.push_back({*view, causes_of(*view)});
    }
    return worst;
  }

  [[nodiscard]] std::vector<RegionTerm> causes_of(const SurveyedView& surveyed) const {
    const PreparedView prepared(surveyed.view, camera_);
    std::vector<RegionTerm> causes;
    for (const std::uint32_t object : visible_from(surveyed.cell)) {
      const std::uint32_t level = level_from(scene_.objects[object], subdivision_.cells[surveyed.cell].box);
      const Cost cost = model_.cost(features_.estimate(object, prepared, level));
      if (cost.fixed_ms + cost.pixel_ms > 0.0) causes.push_back({object, cost.fixed_ms + cost.pixel_ms});
    }
    std::stable_sort(causes.begin(), causes.end(),
                     [](const RegionTerm& a, const RegionTerm& b) { return a.predicted_ms > b.predicted_ms; });
    causes.resize(std::min(causes.size(), kMostCauses));
    return causes;
  }

  const Scene& scene_;
  const ViewSpace& space_;
  const Subdivision& subdivision_;
  const TimeModel& model_;
  const Camera& camera_;
  const SurveyOptions& options_;
  const WorkBudget& budget_;
  FeatureTable features_;
  CellBoxes cell_boxes_;
  CellLocator locator_;
  std::vector<std::uint32_t> all_objects_;
};

}  // namespace

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto at = values.begin() + std::clamp<std::ptrdiff_t>(rank - 1, 0, static_cast<std::ptrdiff_t>(values.size()) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

Survey survey_views(const Scene& scene, const ViewSpace& view_space, const Subdivision& subdivision, const TimeModel& model,
                    const Camera& camera, const SurveyOptions& options, const WorkBudget& budget) {
  return Surveyor(scene, view_space, subdivision, model, camera, options, budget).run();
}

}  // namespace standin
