// report.html: a job's result as one page for someone who has not read the paper (architecture.md, report.html).
//
// The page is self-contained: style, script, chart library (uPlot), numbers and pictures are inside, and its content security policy
// forbids every request. All it shows comes from metrics.json, the parts of placement.json that summarise the job, and pictures; a section
// without numbers does not appear. Beyond the fields that architecture.md lists it reads, where present:
//
//   heat_map: [{x0, z0, x1, z1, before_ms, after_ms}], cells in plan view, highest bound of any direction; metres; after_ms may be null.
//   verify.frames: [{before_ms, after_ms, estimated_before_ms, estimated_after_ms}]; measured ones may be null.
//   causes: {draws_share, triangles_share, pixels_share, objects: [{object, name, ms}]}, what makes regions slow.
//   unsolved: the worst, [{cpv, region, bound_before_ms, lowest_budget_ms, residual_ms, blocking: [{object, name, ms}]}].
//   unsolved_by_object: all of them, [{object, name, regions, worst_ms}].
//   left_out: [sentence, or {stage, reason}].
//   scene.name: used when there is no placement.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace standin {

/// `name`: "view-<k>/original", "view-<k>/with_impostors", "view-<k>/difference" (one view's pictures share `caption`) or "atlas-<page>".
struct ReportPicture {
  std::string name;
  std::string caption;
  std::string png;  // bytes
};

/// `placement` is placement.json, or null where a job has none (survey). Text from scene files may hold anything.
[[nodiscard]] std::string make_report(const nlohmann::json& metrics, const nlohmann::json& placement,
                                      const std::vector<ReportPicture>& pictures);

}  // namespace standin
