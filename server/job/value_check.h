// A value from outside (a configuration file, a flag, a request) against the JSON Schema of its setting.
//
// The part of JSON Schema that settings use: type, enum, maxLength, minimum, exclusiveMinimum, maximum, minItems, maxItems, items, and of
// objects, which have no further members: properties, required.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace standin {

/// Throws Failure(kBadConfig) naming `place` (a path into a file, a flag, a pointer into a body), the value and the constraint.
void check_value(const nlohmann::json& schema, const nlohmann::json& value, const std::string& place);
[[noreturn]] void reject_value(const std::string& place, const nlohmann::json& value, const std::string& constraint);

}  // namespace standin
