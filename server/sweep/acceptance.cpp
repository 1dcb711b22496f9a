#include "server/sweep/acceptance.h"

#include <cmath>
#include <set>

#include "render/base/error.h"
#include "render/base/json_text.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

using nlohmann::json;

[[noreturn]] void reject(const std::string& place, const json& value, const std::string& constraint) {
  throw Failure(ErrorWord::kBadConfig, place + " = " + value.dump() + " violates: " + constraint);
}

double number(const json& value, const std::string& place, bool positive) {
  if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < 0.0 || (positive && value.get<double>() == 0.0))
    reject(place, value, positive ? "a number > 0" : "a number >= 0");
  return value.get<double>();
}

std::uint64_t whole(const json& value, const std::string& place) {
  const double count = number(value, place, false);
  constexpr double kMost = 1e15;
  if (count != std::floor(count) || count > kMost) reject(place, value, "a whole number");
  return static_cast<std::uint64_t>(count);
}

void set(Criterion& criterion, const std::string& key, const json& value, const std::string& place) {
  if (key == "target") {
    if (!value.is_string() || value.get<std::string>().empty()) reject(place, value, "the id of a target");
    criterion.target = value.get<std::string>();
  } else if (key == "budget_ms") {
    criterion.budget_ms = number(value, place, true);
  } else if (key == "max_total_bytes") {
    criterion.max_total_bytes = number(value, place, false);
  } else if (key == "max_texture_bytes") {
    criterion.max_texture_bytes = number(value, place, false);
  } else if (key == "max_unsolved") {
    criterion.max_unsolved = whole(value, place);
  } else {
    throw Failure(ErrorWord::kBadConfig, place + " = " + value.dump() +
                                             " is not a known key: target, budget_ms, max_total_bytes, max_texture_bytes, max_unsolved");
  }
}

Criterion criterion_from_json(const json& object, const std::string& place) {
  if (!object.is_object()) reject(place, object, "an object");
  for (const char* key : {"target", "budget_ms"})
    if (!object.contains(key)) throw Failure(ErrorWord::kBadConfig, place + " lacks \"" + key + "\"");
  Criterion criterion;
  for (const auto& [key, value] : object.items()) set(criterion, key, value, place + "." + key);
  return criterion;
}

std::string bytes_text(double bytes) {
  return json(static_cast<std::uint64_t>(bytes)).dump();
}

std::vector<std::string> failures_of(const Criterion& criterion, const CurvePoint& point) {
  std::vector<std::string> failures;
  const auto within = [&](const std::optional<double>& most, std::uint64_t bytes, const char* what) {
    if (most && static_cast<double>(bytes) > *most)
      failures.push_back(std::to_string(bytes) + " bytes " + what + ", at most " + bytes_text(*most) + " accepted");
  };
  within(criterion.max_total_bytes, point.total_bytes(), "in all");
  within(criterion.max_texture_bytes, point.texture_bytes, "of texture");
  if (point.unsolved > criterion.max_unsolved)
    failures.push_back(std::to_string(point.unsolved) + " CPVs unsolved, at most " + std::to_string(criterion.max_unsolved) + " accepted");
  return failures;
}

}  // namespace

std::vector<Criterion> read_acceptance(const std::filesystem::path& file) {
  return acceptance_from_json(parse_json(read_file(file), file.string()), file.string());
}

std::vector<Criterion> acceptance_from_json(const json& list, const std::string& source) {
  if (!list.is_array() || list.empty()) throw Failure(ErrorWord::kBadConfig, source + " is not a list of at least one criterion");
  std::vector<Criterion> criteria;
  for (std::size_t i = 0; i < list.size(); ++i) criteria.push_back(criterion_from_json(list[i], source + ": [" + std::to_string(i) + "]"));
  return criteria;
}

std::vector<Criterion> criteria_for(const std::vector<Criterion>& criteria, const std::string& target, const std::string& source) {
  std::vector<Criterion> own;
  std::set<std::string> others;
  for (const Criterion& criterion : criteria)
    if (criterion.target == target)
      own.push_back(criterion);
    else
      others.insert(criterion.target);
  if (!own.empty()) return own;
  std::string names;
  for (const auto& name : others) names += (names.empty() ? "" : ", ") + name;
  throw Failure(ErrorWord::kBadConfig, source + " has no criterion for target " + target + ", only for " + names);
}

std::vector<Verdict> judge(const std::vector<Criterion>& criteria, const std::vector<CurvePoint>& points) {
  std::vector<Verdict> verdicts;
  for (const Criterion& criterion : criteria) {
    const CurvePoint* const point = point_at(points, criterion.budget_ms);
    if (point == nullptr) throw Failure(ErrorWord::kInternal, "acceptance: no point at " + milliseconds_text(criterion.budget_ms));
    verdicts.push_back({criterion, failures_of(criterion, *point)});
  }
  return verdicts;
}

std::string sentence(const Verdict& verdict) {
  std::string text = "at " + milliseconds_text(verdict.criterion.budget_ms) + ": ";
  if (verdict.failures.empty()) return text + "passed";
  text += "failed";
  for (const auto& failure : verdict.failures) text += ", " + failure;
  return text;
}

json to_json(const std::vector<Verdict>& verdicts) {
  json list = json::array();
  for (const Verdict& verdict : verdicts) {
    const Criterion& criterion = verdict.criterion;
    json entry = {{"target", criterion.target},
                  {"budget_ms", criterion.budget_ms},
                  {"max_unsolved", criterion.max_unsolved},
                  {"passed", verdict.failures.empty()},
                  {"sentence", sentence(verdict)}};
    if (criterion.max_total_bytes) entry["max_total_bytes"] = *criterion.max_total_bytes;
    if (criterion.max_texture_bytes) entry["max_texture_bytes"] = *criterion.max_texture_bytes;
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace standin
