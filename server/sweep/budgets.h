// Which budgets a sweep looks at, where nobody named any: from what impostors can reach to where none is needed.
//
// Below the lowest budget that the survey calls reachable, some view has no solution; above the highest bound nothing is placed (thesis
// Table 5.1 scales one budget by hand).
#pragma once

#include <string>
#include <vector>

namespace standin {

struct SweepBudgets {
  std::vector<double> budgets_ms;  // ascending, each once
  std::string chosen;              // how, in a sentence
};

inline constexpr int kChosenBudgets = 10;

/// In the middle of equal parts between the two, in few decimals. Throws Failure(kBadUsage) where impostors do not lower the highest bound.
[[nodiscard]] SweepBudgets choose_budgets(double reachable_ms, double worst_bound_ms);
/// Sorted, each once.
[[nodiscard]] std::vector<double> ascending(std::vector<double> budgets_ms);

}  // namespace standin
