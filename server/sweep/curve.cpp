#include "server/sweep/curve.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "render/base/error.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "standin.sweep";
constexpr int kVersion = 1;

[[noreturn]] void broken(const std::string& place, const std::string& what) {
  throw Failure(ErrorWord::kFileBroken, place + " " + what);
}

const json& member(const json& object, const char* key, const std::string& place) {
  if (!object.is_object() || !object.contains(key)) broken(place, "lacks \"" + std::string(key) + "\"");
  return object[key];
}

double number(const json& object, const char* key, const std::string& place) {
  const json& value = member(object, key, place);
  if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < 0.0)
    broken(place + "." + key, "= " + value.dump() + " violates: a number >= 0");
  return value.get<double>();
}

std::uint64_t whole(const json& object, const char* key, const std::string& place) {
  const double value = number(object, key, place);
  constexpr double kMost = 9007199254740992.0;  // up to here doubles count
  if (value != std::floor(value) || value > kMost)
    broken(place + "." + key, "= " + member(object, key, place).dump() + " violates: a whole number");
  return static_cast<std::uint64_t>(value);
}

std::string text(const json& object, const char* key, const std::string& place) {
  const json& value = member(object, key, place);
  if (!value.is_string()) broken(place + "." + key, "= " + value.dump() + " violates: a string");
  return value.get<std::string>();
}

CurvePoint point_from_json(const json& object, const std::string& place) {
  CurvePoint point;
  point.budget_ms = number(object, "budget_ms", place);
  const json& cpv = member(object, "cpv", place);
  point.cpvs = whole(cpv, "count", place + ".cpv");
  point.unsolved = whole(cpv, "unsolved", place + ".cpv");
  point.impostors = whole(object, "impostors", place);
  point.texture_bytes = whole(object, "texture_bytes", place);
  point.geometry_bytes = whole(object, "geometry_bytes", place);
  if (object.contains("lods_bytes")) point.lods_bytes = whole(object, "lods_bytes", place);  // older files have none
  point.lower_bound_bytes = number(object, "memory_lower_bound_bytes", place);
  if (point.unsolved > point.cpvs) broken(place + ".cpv", "has more unsolved than there are");
  return point;
}

}  // namespace

json to_json(const CurvePoint& point) {
  return {{"budget_ms", point.budget_ms},
          {"reachable", point.reachable},
          {"met", point.met()},
          {"cpv", {{"count", point.cpvs}, {"solved", point.cpvs - point.unsolved}, {"unsolved", point.unsolved}}},
          {"impostors", point.impostors},
          {"texture_bytes", point.texture_bytes},
          {"geometry_bytes", point.geometry_bytes},
          {"lods_bytes", point.lods_bytes},
          {"total_bytes", point.total_bytes()},
          {"memory_lower_bound_bytes", point.lower_bound_bytes},
          {"gap", point.gap},
          {"seconds", point.seconds}};
}

json to_json(const CurveSubject& subject) {
  return {{"format", kFormat},
          {"version", kVersion},
          {"scene", {{"name", subject.scene}}},
          {"target", {{"id", subject.target}}},
          {"camera", {{"fov_y_deg", subject.fov_y_deg}, {"width", subject.width}, {"height", subject.height}}}};
}

Curve curve_from_json(const json& object, const std::string& source) {
  const std::string format = text(object, "format", source);
  if (format != kFormat) broken(source, "has format \"" + format + "\", not " + kFormat);
  if (const auto version = whole(object, "version", source); version != kVersion)
    broken(source, "has version " + std::to_string(version) + ", this program reads version " + std::to_string(kVersion));
  Curve curve;
  curve.subject.scene = text(member(object, "scene", source), "name", source + ": scene");
  curve.subject.target = text(member(object, "target", source), "id", source + ": target");
  const json& camera = member(object, "camera", source);
  curve.subject.fov_y_deg = number(camera, "fov_y_deg", source + ": camera");
  curve.subject.width = static_cast<int>(whole(camera, "width", source + ": camera"));
  curve.subject.height = static_cast<int>(whole(camera, "height", source + ": camera"));
  const json& points = member(object, "points", source);
  if (!points.is_array() || points.empty()) broken(source + ": points", "holds no budget");
  for (std::size_t i = 0; i < points.size(); ++i)
    curve.points.push_back(point_from_json(points[i], source + ": points[" + std::to_string(i) + "]"));
  for (std::size_t i = 1; i < curve.points.size(); ++i)
    if (!(curve.points[i - 1].budget_ms < curve.points[i].budget_ms)) broken(source + ": points", "are not in the order of their budgets");
  return curve;
}

const CurvePoint* point_at(const std::vector<CurvePoint>& points, double budget_ms) {
  const auto found = std::ranges::find(points, budget_ms, &CurvePoint::budget_ms);
  return found == points.end() ? nullptr : &*found;
}

std::string milliseconds_text(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return std::string(buffer, end) + " ms";
}

}  // namespace standin
