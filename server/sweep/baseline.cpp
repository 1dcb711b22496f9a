#include "server/sweep/baseline.h"

#include <algorithm>
#include <cstdio>

#include "render/base/error.h"
#include "render/base/json_text.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

using nlohmann::json;

const char* kind_name(Regression kind) {
  return kind == Regression::kMemory ? "memory" : "unsolved";
}

void add_regression(const CurvePoint& before, const CurvePoint& now, double tolerance, std::vector<BudgetRegression>& regressions) {
  if (now.unsolved > before.unsolved) {
    regressions.push_back({now.budget_ms, Regression::kUnsolved, before.unsolved, now.unsolved});
    return;
  }
  const bool comparable = now.unsolved == before.unsolved;
  const double most = (1.0 + tolerance) * static_cast<double>(before.texture_bytes);
  if (comparable && static_cast<double>(now.texture_bytes) > most)
    regressions.push_back({now.budget_ms, Regression::kMemory, before.texture_bytes, now.texture_bytes});
}

std::string camera_text(const CurveSubject& subject) {
  return std::to_string(subject.width) + " x " + std::to_string(subject.height) + " pixels, " + json(subject.fov_y_deg).dump() + " degrees";
}

std::string growth(std::uint64_t before, std::uint64_t after) {
  if (before == 0) return "there was none";
  char text[32];
  std::snprintf(text, sizeof text, "%+.3g %%", 100.0 * (static_cast<double>(after) / static_cast<double>(before) - 1.0));
  return text;
}

}  // namespace

Curve read_baseline(const std::filesystem::path& file) {
  return curve_from_json(parse_json(read_file(file), file.string()), file.string());
}

void require_same_subject(const CurveSubject& baseline, const CurveSubject& now, const std::string& source) {
  const auto require = [&](const char* what, const std::string& was, const std::string& is) {
    if (was != is)
      throw Failure(ErrorWord::kBadUsage, "baseline " + source + " is of another " + what + ": " + was + ", this sweep is of " + is);
  };
  require("scene", baseline.scene, now.scene);
  require("target", baseline.target, now.target);
  require("camera", camera_text(baseline), camera_text(now));
}

CurveComparison compare_curves(const std::vector<CurvePoint>& before, const std::vector<CurvePoint>& now, double tolerance) {
  CurveComparison comparison;
  for (const CurvePoint& point : now) {
    const CurvePoint* const old = point_at(before, point.budget_ms);
    (old != nullptr ? comparison.compared_ms : comparison.not_compared_ms).push_back(point.budget_ms);
    if (old != nullptr) add_regression(*old, point, tolerance, comparison.regressions);
  }
  for (const CurvePoint& old : before)
    if (point_at(now, old.budget_ms) == nullptr) comparison.not_compared_ms.push_back(old.budget_ms);
  std::ranges::sort(comparison.not_compared_ms);
  if (comparison.compared_ms.empty()) throw Failure(ErrorWord::kBadUsage, "the baseline has none of this sweep's budgets");
  return comparison;
}

std::string sentence(const BudgetRegression& regression) {
  const std::string before = std::to_string(regression.before), after = std::to_string(regression.after);
  const std::string at = "at " + milliseconds_text(regression.budget_ms) + ": ";
  if (regression.kind == Regression::kMemory)
    return at + before + " bytes of texture before, " + after + " now (" + growth(regression.before, regression.after) + ")";
  if (regression.before == 0) return at + "the budget was met before, now " + after + " CPVs are unsolved";
  return at + before + " CPVs unsolved before, " + after + " now";
}

json to_json(const CurveComparison& comparison, double tolerance) {
  json regressions = json::array();
  for (const BudgetRegression& one : comparison.regressions)
    regressions.push_back({{"budget_ms", one.budget_ms},
                           {"kind", kind_name(one.kind)},
                           {"before", one.before},
                           {"after", one.after},
                           {"sentence", sentence(one)}});
  return {{"tolerance", tolerance},
          {"compared_ms", comparison.compared_ms},
          {"not_compared_ms", comparison.not_compared_ms},
          {"regressions", std::move(regressions)}};
}

}  // namespace standin
