#include "server/sweep/budgets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/base/error.h"

namespace standin {
namespace {

// What a survey found is no round number, and nobody types it.
std::string about_ms(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g ms", value);
  return text;
}

// To a tenth of a step at least, in decimals: a budget that can be typed again.
double in_few_decimals(double value, double step) {
  const double per_unit = std::pow(10.0, std::max(0.0, 1.0 - std::floor(std::log10(step))));
  return std::round(value * per_unit) / per_unit;
}

}  // namespace

SweepBudgets choose_budgets(double reachable_ms, double worst_bound_ms) {
  const double step = (worst_bound_ms - reachable_ms) / kChosenBudgets;
  if (!(step > 1e-9 * worst_bound_ms))
    throw Failure(ErrorWord::kBadUsage, "no budgets to choose: the highest bound is " + about_ms(worst_bound_ms) +
                                            " and impostors lower it to no less than " + about_ms(reachable_ms) +
                                            "; name some with --budgets-ms");
  SweepBudgets chosen;
  for (int i = 0; i < kChosenBudgets; ++i) chosen.budgets_ms.push_back(in_few_decimals(reachable_ms + (i + 0.5) * step, step));
  chosen.chosen = std::to_string(kChosenBudgets) + " budgets, evenly between the lowest reachable one (" + about_ms(reachable_ms) +
                  ") and the highest bound of a region (" + about_ms(worst_bound_ms) + ")";
  return chosen;
}

std::vector<double> ascending(std::vector<double> budgets_ms) {
  std::ranges::sort(budgets_ms);
  budgets_ms.erase(std::unique(budgets_ms.begin(), budgets_ms.end()), budgets_ms.end());
  return budgets_ms;
}

}  // namespace standin
