#include "placement/view_space/region_sample.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace standin {
namespace {

// That the demand is shared out by: views this near to the worst, as a share of its time.
constexpr double kSlow = 0.9;

struct TimedView {
  View view;
  double predicted_ms = 0.0;
};

}  // namespace

void cost_by_views(const FeatureTable& features, const TimeModel& model, RegionViews region, std::span<const std::uint32_t> objects,
                   std::span<const std::uint8_t> levels, double frame_ms, double bound_ms, std::span<Cost> costs) {
  std::vector<TimedView> views;
  climb_to_worst(std::move(region), kSampledViews, [&](const View& view) {
    views.push_back({view, model.predicted_ms(features.frame(objects, view, levels))});
    return views.back().predicted_ms;
  });
  const double worst_ms = std::ranges::max_element(views, {}, &TimedView::predicted_ms)->predicted_ms;
  std::vector<double> share(objects.size(), 0.0);
  for (const TimedView& slow : views) {
    if (slow.predicted_ms < kSlow * worst_ms) continue;
    const PreparedView prepared(slow.view, features.camera());
    for (std::size_t k = 0; k < objects.size(); ++k) {
      const Cost cost = model.cost(features.estimate(objects[k], prepared, levels.empty() ? 0U : levels[k]));
      share[k] += cost.fixed_ms + cost.pixel_ms;
    }
  }
  const double demand_ms = std::max(0.0, std::min(bound_ms, (1.0 + kSampledMargin) * worst_ms) - frame_ms);
  const double sum = std::accumulate(share.begin(), share.end(), 0.0);
  for (std::size_t k = 0; k < costs.size(); ++k) costs[k] = {sum > 0.0 ? demand_ms * (share[k] / sum) : 0.0, 0.0};
}

}  // namespace standin
