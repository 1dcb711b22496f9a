#include "render/device/sample_statistics.h"

#include <algorithm>

namespace standin {
namespace {

int count_contaminated(std::span<const Repeat> repeats) {
  return static_cast<int>(std::count_if(repeats.begin(), repeats.end(), [](const Repeat& r) { return r.contaminated(); }));
}

std::vector<double> usable_times_ms(std::span<const Repeat> repeats, bool any_clean) {
  std::vector<double> times;
  for (const auto& repeat : repeats)
    if (!any_clean || !repeat.contaminated()) times.push_back(repeat.cpu_ms);
  std::sort(times.begin(), times.end());
  return times;
}

}  // namespace

bool needs_another(std::span<const Repeat> repeats, int wanted) {
  const int drawn = static_cast<int>(repeats.size());
  return drawn - count_contaminated(repeats) < wanted && drawn < 2 * wanted;
}

FrameSample summarise(std::span<const Repeat> repeats, double normalised_per_raw) {
  const int contaminated = count_contaminated(repeats);
  const auto times = usable_times_ms(repeats, contaminated < static_cast<int>(repeats.size()));
  const double least_ms = times.front();
  const double median_ms = times[times.size() / 2];
  return {.milliseconds = least_ms * normalised_per_raw,
          .raw_milliseconds = least_ms,
          .spread = least_ms > 0.0 ? (median_ms - least_ms) / least_ms : 0.0,
          .rejected = contaminated};
}

}  // namespace standin
