// Golden vectors: cases computed in 60-digit arithmetic, one JSON file a formula, "inf" written as a string.
//
// They are read from tests/golden, or from the folder STANDIN_GOLDEN_DIR names. A missing file or one without cases fails; each test prints
// how many it ran.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace standin::test {

/// The whole file; null when it is missing, which fails.
[[nodiscard]] inline nlohmann::json golden_file(const std::string& file) {
  const char* folder = std::getenv("STANDIN_GOLDEN_DIR");
  const std::string path = std::string(folder != nullptr ? folder : STANDIN_SOURCE_DIR "/tests/golden") + "/" + file;
  std::ifstream stream(path);
  if (stream) return nlohmann::json::parse(stream);
  ADD_FAILURE() << "golden file missing: " << path;
  return nullptr;
}

[[nodiscard]] inline nlohmann::json golden_cases(const std::string& file) {
  const auto whole = golden_file(file);
  if (whole.is_null()) return nlohmann::json::array();
  const auto& cases = whole.at("cases");
  EXPECT_FALSE(cases.empty()) << file << " holds no case";
  std::printf("%zu cases of %s\n", cases.size(), file.c_str());
  return cases;
}

/// A number, or infinity where the vector says "inf" (or null).
[[nodiscard]] inline double golden_number(const nlohmann::json& value) {
  if (value.is_number()) return value.get<double>();
  return std::numeric_limits<double>::infinity();
}

}  // namespace standin::test
