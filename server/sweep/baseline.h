// Is a curve worse than an earlier one? The regression test that users put into their continuous integration (no paper has one).
//
// Placement is deterministic, so a change in memory comes from a change in the scene, the target or this program, never from noise; the
// tolerance says what growth is small enough to let pass. Memory is texture_bytes, the objective of the placement.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/sweep/curve.h"

namespace standin {

/// Which way a budget got worse.
enum class Regression { kMemory, kUnsolved };

struct BudgetRegression {
  double budget_ms = 0.0;
  Regression kind = Regression::kMemory;
  std::uint64_t before = 0;  // texture bytes, or unsolved CPVs
  std::uint64_t after = 0;
};

struct CurveComparison {
  std::vector<double> compared_ms;      // budgets that both curves have
  std::vector<double> not_compared_ms;  // those that one of them lacks
  std::vector<BudgetRegression> regressions;
};

/// Reads an earlier sweep.json. Throws Failure(kFileMissing, kFileBroken).
[[nodiscard]] Curve read_baseline(const std::filesystem::path& file);
/// Throws Failure(kBadUsage) naming what differs, where the baseline is of another scene, camera or target.
void require_same_subject(const CurveSubject& baseline, const CurveSubject& now, const std::string& source);

/// A budget gets worse when it leaves more CPVs unsolved than before, or as many with memory above (1 + tolerance) times that of before.
/// Where fewer are unsolved than before, memory is not compared: solving them costs some. Throws Failure(kBadUsage) where the curves have
/// no budget in common.
[[nodiscard]] CurveComparison compare_curves(const std::vector<CurvePoint>& before, const std::vector<CurvePoint>& now, double tolerance);

/// "at 16 ms: 1200 bytes of texture before, 1500 now (+25 %)".
[[nodiscard]] std::string sentence(const BudgetRegression& regression);
[[nodiscard]] nlohmann::json to_json(const CurveComparison& comparison, double tolerance);

}  // namespace standin
