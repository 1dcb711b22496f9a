#include "estimation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

/// Nearest-rank quantile.
double quantile(std::vector<double> values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

[[noreturn]] void refuse(std::size_t row, const std::string& what, double value) {
  throw Failure(ErrorWord::kBadUsage, "timed frame " + std::to_string(row) + ": " + what + " is " + std::to_string(value));
}

}  // namespace

void check_frames(const std::vector<TimedFrame>& frames) {
  for (std::size_t row = 0; row < frames.size(); ++row) {
    if (!(frames[row].milliseconds > 0.0) || std::isinf(frames[row].milliseconds))
      refuse(row, "its time in milliseconds, which must be positive and finite,", frames[row].milliseconds);
    for (std::size_t i = 0; i < kTermCount; ++i)
      if (!(frames[row].features.value[i] >= 0.0) || std::isinf(frames[row].features.value[i]))
        refuse(row, "feature " + std::string(term_name(static_cast<Term>(i))) + ", which must be finite and >= 0,",
               frames[row].features.value[i]);
  }
}

Evaluation summarise(const std::vector<HeldOut>& frames, const std::vector<double>& bounds_ms) {
  std::vector<double> errors, looseness;
  Evaluation result;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    errors.push_back(std::abs(frames[i].predicted_ms - frames[i].measured_ms) / frames[i].measured_ms);
    looseness.push_back(bounds_ms[i] / frames[i].measured_ms);
    if (bounds_ms[i] < frames[i].measured_ms) ++result.misses;
  }
  result.frames = static_cast<std::uint32_t>(frames.size());
  result.median_error = quantile(errors, 0.5);
  result.p90_error = quantile(errors, 0.9);
  result.coverage = 1.0 - static_cast<double>(result.misses) / static_cast<double>(frames.size());
  result.bound_over_measured_median = quantile(looseness, 0.5);
  return result;
}

std::uint32_t most_misses(std::uint32_t frames, double coverage) {
  constexpr double kRare = 0.05;
  // Terms of the binomial distribution from none up, in logarithms: (1 - p)^n alone may be too small for a double.
  const double n = frames;
  double tail = 1.0;
  for (std::uint32_t misses = 0; misses < frames; ++misses) {
    const double k = misses;
    tail -= std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log1p(-coverage) +
                     (n - k) * std::log(coverage));
    if (tail <= kRare) return misses;
  }
  return frames;
}

Evaluation evaluate(const TimeModel& model, const std::vector<TimedFrame>& all_frames) {
  check_frames(all_frames);
  const std::vector<TimedFrame> frames = steady_frames(all_frames);
  if (frames.empty()) throw Failure(ErrorWord::kBadUsage, "no timed frame whose repeats agree to evaluate the time model on");
  std::vector<HeldOut> held_out;
  std::vector<double> bounds_ms;
  for (const TimedFrame& frame : frames) {
    held_out.push_back({model.predicted_ms(frame.features), frame.milliseconds});
    bounds_ms.push_back(model.bound_ms(held_out.back().predicted_ms));
  }
  Evaluation result = summarise(held_out, bounds_ms);
  result.unsteady_frames = static_cast<std::uint32_t>(all_frames.size() - frames.size());
  return result;
}

}  // namespace standin
