#include "estimation/time_model.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace standin {

Cost TimeModel::cost(const Features& features) const {
  Cost cost;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    const double milliseconds = milliseconds_per_unit[i] * features.value[i];
    (is_pixel_term(static_cast<Term>(i)) ? cost.pixel_ms : cost.fixed_ms) += milliseconds;
  }
  return cost;
}

double TimeModel::predicted_ms(const Features& frame) const {
  if (combination == Combination::kSum) return predicted_ms(cost(frame));
  std::array<double, 3> of_stage{};
  for (std::size_t i = 0; i < kTermCount; ++i)
    of_stage[static_cast<std::size_t>(stage_of(static_cast<Term>(i)))] += milliseconds_per_unit[i] * frame.value[i];
  const auto [shared, geometry, fill] = of_stage;
  return shared + std::max(geometry, fill);
}

double TimeModel::predicted_ms(const Cost& frame) const {
  return frame.fixed_ms + frame.pixel_ms;
}

double TimeModel::most_pixel_ms(std::span<const Term> terms, double passed_pixels) const {
  double costliest = 0.0;
  for (const Term term : terms) costliest = std::max(costliest, milliseconds_per_unit[static_cast<std::size_t>(term)]);
  return passed_pixels * costliest;
}

double TimeModel::bound_ms(double predicted_ms) const {
  double bound = bound_steps.empty() ? predicted_ms : 0.0;
  for (const BoundStep& step : bound_steps) {
    bound = std::max(bound, step.factor * std::min(predicted_ms, step.until_ms));
    if (predicted_ms < step.until_ms) break;
  }
  return bound;
}

double TimeModel::predicted_budget_ms(double budget_ms) const {
  if (!(budget_ms >= 0.0)) return -1.0;  // bound_ms(0) = 0
  // Non-negative doubles are ordered as their bit patterns are: bisect over these for the last one whose bound is within the budget.
  std::uint64_t within = std::bit_cast<std::uint64_t>(0.0);
  std::uint64_t beyond = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  while (beyond - within > 1) {
    const std::uint64_t middle = within + (beyond - within) / 2;
    (bound_ms(std::bit_cast<double>(middle)) <= budget_ms ? within : beyond) = middle;
  }
  return std::bit_cast<double>(within);
}

}  // namespace standin
