#include "estimation/conformal.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace standin {
namespace {

constexpr std::size_t kMaxSteps = 10;
// A prediction of nothing says nothing; it would make every ratio infinite.
constexpr double kLeastPredictedMs = 1e-6;

/// Rank (from 1) of the ratio to take among n.
std::size_t conformal_rank(std::size_t n, double coverage) {
  return static_cast<std::size_t>(std::ceil((static_cast<double>(n) + 1.0) * coverage));
}

double ratio_of(const HeldOut& frame) {
  return frame.measured_ms / std::max(frame.predicted_ms, kLeastPredictedMs);
}

double quantile(std::vector<double> ratios, double coverage) {
  std::sort(ratios.begin(), ratios.end());
  const std::size_t rank = conformal_rank(ratios.size(), coverage);
  return rank <= ratios.size() ? ratios[rank - 1] : kTooFewFactor * ratios.back();
}

double conformal_ratio(const HeldOut* first, const HeldOut* last, double coverage) {
  std::vector<double> ratios;
  for (const HeldOut* frame = first; frame != last; ++frame) ratios.push_back(ratio_of(*frame));
  return quantile(std::move(ratios), coverage);
}

/// By how much the steps must rise for every group to be covered.
double raise_for_groups(const std::vector<HeldOut>& held_out, const std::vector<BoundStep>& steps, double coverage) {
  std::map<std::uint32_t, std::vector<double>> ratios;
  for (const HeldOut& frame : held_out) {
    const auto step = std::find_if(steps.begin(), steps.end(), [&](const BoundStep& s) { return frame.predicted_ms < s.until_ms; });
    ratios[frame.group].push_back(ratio_of(frame) / step->factor);
  }
  double most = 1.0;
  for (auto& [group, of_group] : ratios) most = std::max(most, quantile(std::move(of_group), coverage));
  return most;
}

/// Where the steps begin in the sorted frames, and their end; equal predictions stay in one step.
std::vector<std::size_t> step_borders(const std::vector<HeldOut>& sorted, double coverage) {
  std::size_t steps = kMaxSteps;
  while (steps > 1 && sorted.size() / steps < 2 * least_frames_for(coverage)) --steps;
  std::vector<std::size_t> borders = {0};
  for (std::size_t i = 1; i < steps; ++i) {
    const double predicted_ms = sorted[i * sorted.size() / steps].predicted_ms;
    const auto first =
        std::partition_point(sorted.begin(), sorted.end(), [=](const HeldOut& frame) { return frame.predicted_ms < predicted_ms; });
    const auto border = static_cast<std::size_t>(first - sorted.begin());
    if (border > borders.back()) borders.push_back(border);
  }
  borders.push_back(sorted.size());
  return borders;
}

}  // namespace

std::size_t least_frames_for(double coverage) {
  auto frames = static_cast<std::size_t>(coverage / (1.0 - coverage));
  while (conformal_rank(frames, coverage) > frames) ++frames;
  return frames;
}

std::vector<BoundStep> conformal_steps(std::vector<HeldOut> held_out, double coverage) {
  std::sort(held_out.begin(), held_out.end(), [](const HeldOut& a, const HeldOut& b) {
    return a.predicted_ms != b.predicted_ms ? a.predicted_ms < b.predicted_ms : a.measured_ms < b.measured_ms;
  });
  std::vector<std::size_t> borders = step_borders(held_out, coverage);
  std::vector<BoundStep> result;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const bool is_last = borders[i + 1] == held_out.size();
    const double until_ms = is_last ? std::numeric_limits<double>::infinity() : held_out[borders[i + 1]].predicted_ms;
    result.push_back({until_ms, conformal_ratio(held_out.data() + borders[i], held_out.data() + borders[i + 1], coverage)});
  }
  const double raise = raise_for_groups(held_out, result, coverage);
  for (BoundStep& step : result) step.factor *= raise;
  return result;
}

}  // namespace standin
