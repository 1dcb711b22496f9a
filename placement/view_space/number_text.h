// Numbers in sentences: six significant digits, no trailing zeros, the same on every locale.
#pragma once

#include <charconv>
#include <string>

namespace standin {

[[nodiscard]] inline std::string number_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6).ptr;
  return {text, end};
}

}  // namespace standin
