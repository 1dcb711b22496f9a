// JSON that a stranger may have written. Whoever copies, compares or shows a value goes down as deep as it is nested, on the stack: what is
// nested without end is refused before there is a value.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace standin {

/// Whether brackets that are not in a string open more than `deepest` times before they close.
[[nodiscard]] inline bool nested_deeper(std::string_view json, int deepest) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      if (++depth > deepest) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

/// Throws Failure(word) where `name` is nested deeper or is no JSON.
[[nodiscard]] inline nlohmann::json parse_json(std::string_view text, const std::string& name, ErrorWord word = ErrorWord::kFileBroken,
                                               int deepest = 64) {
  if (nested_deeper(text, deepest)) throw Failure(word, name + " is nested more than " + std::to_string(deepest) + " deep");
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  if (value.is_discarded()) throw Failure(word, name + " is not JSON");
  return value;
}

}  // namespace standin
