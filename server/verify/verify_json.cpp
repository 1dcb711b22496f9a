#include "server/verify/verify_json.h"

#include <algorithm>

#include "placement/view_space/survey.h"

namespace standin {
namespace {

using nlohmann::json;

const char* origin_name(ViewOrigin origin) {
  switch (origin) {
    case ViewOrigin::kRandom:
      return "random";
    case ViewOrigin::kCorner:
      return "corner";
    case ViewOrigin::kBorder:
      return "border";
    case ViewOrigin::kTight:
      return "tight";
    case ViewOrigin::kPath:
      return "path";
    case ViewOrigin::kSurveyed:
      break;
  }
  return "surveyed";
}

json optional_number(const std::optional<double>& value) {
  return value ? json(*value) : json();
}

json percentiles(const std::vector<double>& values) {
  if (values.empty()) return {{"p50", nullptr}, {"p99", nullptr}, {"max", nullptr}};
  return {{"p50", percentile(values, 0.5)}, {"p99", percentile(values, 0.99)}, {"max", *std::ranges::max_element(values)}};
}

std::vector<double> measured(const VerifyResult& result, std::optional<double> VerifiedView::*time) {
  std::vector<double> values;
  for (const auto& view : result.views)
    if (view.*time) values.push_back(*(view.*time));
  return values;
}

json frame_json(const VerifiedView& view) {
  const auto& p = view.view.position;
  const auto& d = view.view.direction;
  return {{"origin", origin_name(view.origin)},
          {"position", {p.x, p.y, p.z}},
          {"direction", {d.x, d.y, d.z}},
          {"cpv", view.cpv ? json(*view.cpv) : json()},
          {"estimated_before_ms", view.estimated_before_ms},
          {"estimated_after_ms", view.estimated_after_ms},
          {"before_ms", optional_number(view.measured_before_ms)},
          {"after_ms", optional_number(view.measured_after_ms)},
          {"mean_error", view.mean_error},
          {"mean_flip", view.mean_flip}};
}

}  // namespace

json verify_json(const VerifyResult& result) {
  json frames = json::array();
  for (const auto& view : result.views) frames.push_back(frame_json(view));
  json pictures = json::array();
  for (std::size_t k = 0; k < result.pictures.size(); ++k)
    pictures.push_back({{"file", picture_file(k)}, {"frame", result.pictures[k].view}});
  const bool was_measured = !measured(result, &VerifiedView::measured_after_ms).empty();
  return {{"views", result.views.size()},
          {"over_budget_estimated", result.over_budget_estimated},
          {"over_budget_measured", was_measured ? json(result.over_budget_measured) : json()},
          {"worst_over_budget", was_measured ? json(result.worst_over_budget) : json()},
          {"frame_ms_before", percentiles(measured(result, &VerifiedView::measured_before_ms))},
          {"frame_ms_after", percentiles(measured(result, &VerifiedView::measured_after_ms))},
          {"measured_coverage", optional_number(result.measured_coverage)},
          {"worst_before_over_surveyed", optional_number(result.worst_before_over_surveyed)},
          {"left_out", result.left_out},
          {"pictures", std::move(pictures)},
          {"frames", std::move(frames)}};
}

json image_json(const VerifyResult& result) {
  const bool judged = result.judged_views > 0;
  const double baseless =
      static_cast<double>(result.baseless_pixels) / static_cast<double>(std::max<std::uint64_t>(1, result.shown_pixels));
  json image = {{"views", result.judged_views},
                {"gap_pixels", judged ? json(result.gap_pixels) : json()},
                {"max_parallax_ratio", judged ? json(result.max_parallax_ratio) : json()},
                {"baseless_pixel_share", result.shown_pixels > 0 ? json(baseless) : json()},
                {"silhouette_bloat_px", optional_number(result.silhouette_bloat_px)},
                {"mean_error", result.mean_error},
                {"mean_flip", result.mean_flip}};
  if (result.lods_mean_error) {
    image["lods_mean_error"] = *result.lods_mean_error;
    image["lods_mean_flip"] = *result.lods_mean_flip;
  }
  return image;
}

}  // namespace standin
