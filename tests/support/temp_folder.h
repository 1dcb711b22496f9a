// A folder of a test's own, gone when the test is.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <string>

namespace standin::test {

class TempFolder : public testing::Test {
 protected:
  TempFolder() { std::filesystem::create_directories(root_); }
  ~TempFolder() override { std::filesystem::remove_all(root_); }

  [[nodiscard]] std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(root_), {}));
  }

  std::filesystem::path root_ = std::filesystem::temp_directory_path() / ("standin_test_" + std::to_string(::getpid()));
};

}  // namespace standin::test
