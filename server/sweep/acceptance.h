// What a team promised for its machines: criteria on named targets that a sweep's points must meet (no paper has this; a release test has).
//
// A file holds a list, one entry a criterion:
//   [{"target": "osmesa-llvmpipe", "budget_ms": 16, "max_total_bytes": 5e6, "max_unsolved": 0}]
// One file may speak of several targets; a sweep is judged by those of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/sweep/curve.h"

namespace standin {

struct Criterion {
  std::string target;  // id of a target file
  double budget_ms = 0.0;
  std::optional<double> max_total_bytes;
  std::optional<double> max_texture_bytes;
  std::uint64_t max_unsolved = 0;
};

struct Verdict {
  Criterion criterion;
  std::vector<std::string> failures;  // empty: passed
};

/// Throws Failure(kFileMissing, kFileBroken) and, with the place of a key that is unknown, missing or out of range, Failure(kBadConfig).
[[nodiscard]] std::vector<Criterion> read_acceptance(const std::filesystem::path& file);
[[nodiscard]] std::vector<Criterion> acceptance_from_json(const nlohmann::json& list, const std::string& source);
/// Those of one target. Throws Failure(kBadConfig) naming the targets there are, where it is none of them: nothing would be judged.
[[nodiscard]] std::vector<Criterion> criteria_for(const std::vector<Criterion>& criteria, const std::string& target,
                                                  const std::string& source);

/// `points` has the budget of each criterion.
[[nodiscard]] std::vector<Verdict> judge(const std::vector<Criterion>& criteria, const std::vector<CurvePoint>& points);

/// "at 16 ms: passed", "at 16 ms: failed, 6200000 bytes in all, at most 5000000 accepted".
[[nodiscard]] std::string sentence(const Verdict& verdict);
[[nodiscard]] nlohmann::json to_json(const std::vector<Verdict>& verdicts);

}  // namespace standin
