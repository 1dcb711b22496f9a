// Memory against the frame-time budget: the curve of thesis Table 5.1 (tests 1 to 6), as sweep.json holds it.
//
// The thesis scales its budget by hand and reads memory off each run. A curve is what users keep in their repository: what it was measured
// for (scene, camera, target) stands beside the points, so that no two curves are compared that do not belong together.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace standin {

/// What `place` would give at one budget.
struct CurvePoint {
  double budget_ms = 0.0;
  bool reachable = false;  // the survey promised it for all views, from cautious costs: a budget a little below may be met too
  std::uint64_t cpvs = 0;
  std::uint64_t unsolved = 0;
  std::uint64_t impostors = 0;
  std::uint64_t texture_bytes = 0;  // the objective
  std::uint64_t geometry_bytes = 0;
  std::uint64_t lods_bytes = 0;    // of levels of detail
  double lower_bound_bytes = 0.0;  // of texture_bytes
  double gap = 0.0;
  double seconds = 0.0;  // what this budget took beside what all share

  [[nodiscard]] bool met() const { return unsolved == 0; }
  [[nodiscard]] std::uint64_t total_bytes() const { return texture_bytes + geometry_bytes + lods_bytes; }
};

struct CurveSubject {
  std::string scene;   // file name
  std::string target;  // id
  double fov_y_deg = 0.0;
  int width = 0;
  int height = 0;
  friend bool operator==(const CurveSubject&, const CurveSubject&) = default;
};

struct Curve {
  CurveSubject subject;
  std::vector<CurvePoint> points;  // ascending budgets, each once
};

[[nodiscard]] nlohmann::json to_json(const CurvePoint& point);
[[nodiscard]] nlohmann::json to_json(const CurveSubject& subject);
/// Of a whole sweep.json; `source` names it. Throws Failure(kFileBroken) with the place of what is missing or out of range.
[[nodiscard]] Curve curve_from_json(const nlohmann::json& object, const std::string& source);

/// The point at exactly this budget; null where there is none.
[[nodiscard]] const CurvePoint* point_at(const std::vector<CurvePoint>& points, double budget_ms);
/// "16.25 ms", as short as it can be told from its neighbours.
[[nodiscard]] std::string milliseconds_text(double value);

}  // namespace standin
