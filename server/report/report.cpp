#include "server/report/report.h"

#include <array>
#include <string_view>

#include "embedded_page.h"
#include "server/report/base64.h"
#include "server/report/page.h"

namespace standin {
namespace {

using nlohmann::json;

std::string object_name(const json& objects, std::size_t id) {
  if (id < objects.size()) {
    const std::string name = objects[id].value("name", "");
    if (!name.empty()) return name;
  }
  return "object " + std::to_string(id);
}

/// "oak 12" or "oak 12 and 3 more".
std::string label(const json& ids, const json& objects) {
  if (ids.empty()) return "";
  std::string text = object_name(objects, ids.front().get<std::size_t>());
  if (ids.size() > 1) text += " and " + std::to_string(ids.size() - 1) + " more";
  return text;
}

json impostor_rows(const json& placement) {
  json rows = json::array();
  const json objects = placement.value("/scene/objects"_json_pointer, json::array());
  for (const auto& impostor : placement.value("impostors", json::array())) {
    const json ids = impostor.value("objects", json::array());
    rows.push_back({{"id", impostor.value("id", rows.size())},
                    {"label", label(ids, objects)},
                    {"objects", ids.size()},
                    {"technique", impostor.value("technique", "")},
                    {"layers", impostor.value("layers", json::array()).size()},
                    {"quads", impostor.value("quads", 0)},
                    {"texture_bytes", impostor.value("texture_bytes", std::uint64_t{0})},
                    {"geometry_bytes", impostor.value("geometry_bytes", std::uint64_t{0})},
                    {"time_bound_ms", impostor.value("time_bound_ms", json())}});
  }
  return rows;
}

/// What the page says about the job itself; cells and regions of placement.json stay out of the page.
json job_summary(const json& metrics, const json& placement) {
  const std::string fallback = metrics.value("/scene/name"_json_pointer, std::string());
  return {{"scene_name", placement.value("/scene/name"_json_pointer, fallback)},
          {"camera", placement.value("camera", json::object())},
          {"target", {{"id", placement.value("/target/id"_json_pointer, std::string())}}},
          {"view_space", {{"kind", placement.value("/view_space/kind"_json_pointer, std::string())}}}};
}

json picture_rows(const std::vector<ReportPicture>& pictures) {
  json rows = json::array();
  for (const auto& picture : pictures)
    rows.push_back({{"name", picture.name}, {"caption", picture.caption}, {"src", "data:image/png;base64," + base64(picture.png)}});
  return rows;
}

}  // namespace

std::string make_report(const json& metrics, const json& placement, const std::vector<ReportPicture>& pictures) {
  const json result = placement.is_null() ? json::object() : placement;
  const json data = {{"metrics", metrics},
                     {"job", job_summary(metrics, result)},
                     {"impostors", impostor_rows(result)},
                     {"pictures", picture_rows(pictures)}};
  constexpr std::array kScripts = {embedded::text_js,   embedded::charts_js,   embedded::heat_map_js,
                                   embedded::memory_js, embedded::sections_js, embedded::main_js};
  return make_page(kScripts, data);
}

}  // namespace standin
