#include "render/device/sample_statistics.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace standin {
namespace {

std::ptrdiff_t count_contaminated(std::span<const Repeat> repeats) {
  return std::count_if(repeats.begin(), repeats.end(), [](const Repeat& repeat) { return repeat.contaminated(); });
}

double quantile(const std::vector<double>& ascending, double fraction) {
  return ascending[static_cast<std::size_t>(fraction * static_cast<double>(ascending.size() - 1))];
}

}  // namespace

Clock fitting_clock(std::span<const Duration> durations) {
  return std::all_of(durations.begin(), durations.end(), [](const Duration& duration) { return duration.wall_ms > 2.0 * duration.cpu_ms; })
             ? Clock::kWall
             : Clock::kThreadCpu;
}

double least_ms(std::span<const Duration> durations, Clock clock) {
  double least = std::numeric_limits<double>::infinity();
  for (const Duration& duration : durations) least = std::min(least, on_clock(duration, clock).cpu_ms);
  return least;
}

bool needs_another(std::span<const Repeat> repeats, int wanted) {
  const auto drawn = static_cast<std::ptrdiff_t>(repeats.size());
  return drawn - count_contaminated(repeats) < wanted && drawn < 2 * std::ptrdiff_t{wanted};
}

FrameSample summarise(std::span<const Repeat> repeats, double reference_ms) {
  const auto contaminated = count_contaminated(repeats);
  const bool any_clean = contaminated < static_cast<std::ptrdiff_t>(repeats.size());
  std::vector<double> ratios;
  std::vector<double> raw_ms;
  double spent_ms = 0.0;
  for (const auto& repeat : repeats) {
    spent_ms += repeat.frame.cpu_ms + repeat.reference.cpu_ms;
    if (any_clean && repeat.contaminated()) continue;
    ratios.push_back(repeat.frame.cpu_ms / repeat.reference.cpu_ms);
    raw_ms.push_back(repeat.frame.cpu_ms);
  }
  std::sort(ratios.begin(), ratios.end());
  const double median = quantile(ratios, 0.5);
  return {.milliseconds = reference_ms * median,
          .raw_milliseconds = *std::min_element(raw_ms.begin(), raw_ms.end()),
          .spread = median > 0.0 ? (quantile(ratios, 0.75) - quantile(ratios, 0.25)) / median : 0.0,
          .rejected = static_cast<int>(contaminated),
          .spent_milliseconds = spent_ms};
}

}  // namespace standin
