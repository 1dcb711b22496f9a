#include "server/job/value_check.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr double kExactIntegers = 9007199254740992.0;  // 2^53: beyond, a JSON number need not mean what it says

bool is_exact_integer(double value) {
  return value == std::floor(value) && std::abs(value) <= kExactIntegers;
}

void check_type(const json& schema, const json& value, const std::string& place) {
  const std::string type = schema.at("type");
  const bool ok =
      (type == "string" && value.is_string()) || (type == "number" && value.is_number()) ||
      (type == "integer" && (value.is_number_integer() || (value.is_number_float() && is_exact_integer(value.get<double>())))) ||
      (type == "boolean" && value.is_boolean()) || (type == "array" && value.is_array()) || (type == "object" && value.is_object());
  if (!ok) reject_value(place, value, "a value of type " + type + ", got " + value.type_name());
}

void check_number(const json& schema, const json& value, const std::string& place) {
  const double number = value.get<double>();
  if (!std::isfinite(number)) reject_value(place, value, "a finite number");
  if (schema.contains("minimum") && number < schema["minimum"]) reject_value(place, value, ">= " + schema["minimum"].dump());
  if (schema.contains("exclusiveMinimum") && number <= schema["exclusiveMinimum"])
    reject_value(place, value, "> " + schema["exclusiveMinimum"].dump());
  if (schema.contains("maximum") && number > schema["maximum"]) reject_value(place, value, "<= " + schema["maximum"].dump());
}

void check_string(const json& schema, const json& value, const std::string& place) {
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end())
    reject_value(place, value, "one of " + schema["enum"].dump());
  if (schema.contains("maxLength") && value.get_ref<const std::string&>().size() > schema["maxLength"])
    reject_value(place, value, "at most " + schema["maxLength"].dump() + " bytes");
}

void check_members(const json& schema, const json& value, const std::string& place) {
  for (const json& name : schema.value("required", json::array()))
    if (!value.contains(name.get<std::string>())) reject_value(place, value, "has " + name.dump());
  for (const auto& [name, member] : value.items()) {
    if (!schema.contains("properties") || !schema["properties"].contains(name))
      reject_value(place, value, "has no member " + json(name).dump());
    check_value(schema["properties"][name], member, place + "." + name);
  }
}

}  // namespace

void reject_value(const std::string& place, const json& value, const std::string& constraint) {
  constexpr std::size_t kShown = 200;
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + " ...";
  throw Failure(ErrorWord::kBadConfig, place + " = " + text + " violates: " + constraint);
}

void check_value(const json& schema, const json& value, const std::string& place) {
  check_type(schema, value, place);
  if (value.is_number()) check_number(schema, value, place);
  if (value.is_string()) check_string(schema, value, place);
  if (value.is_object()) check_members(schema, value, place);
  if (!value.is_array()) return;
  if (schema.contains("minItems") && value.size() < schema["minItems"])
    reject_value(place, value, "at least " + schema["minItems"].dump() + " items");
  if (schema.contains("maxItems") && value.size() > schema["maxItems"])
    reject_value(place, value, "at most " + schema["maxItems"].dump() + " items");
  for (std::size_t i = 0; i < value.size(); ++i) check_value(schema.at("items"), value[i], place + "[" + std::to_string(i) + "]");
}

}  // namespace standin
