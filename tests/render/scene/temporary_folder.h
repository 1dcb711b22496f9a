// A folder of its own for each test, and the word a failing load throws.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "render/base/error.h"
#include "render/scene/load.h"

namespace standin::test {

class TemporaryFolder {
 public:
  TemporaryFolder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) / ("standin_" + std::string(test->test_suite_name()) + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The word of the Failure that loading `file` throws; its sentence must hold `part`.
inline ErrorWord load_failure(const std::filesystem::path& file, const std::string& part = "", const LoadOptions& options = {}) {
  try {
    (void)load_scene(file, options);
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
    return failure.word();
  }
  ADD_FAILURE() << "loaded: " << file;
  return ErrorWord::kInternal;
}

/// Sum of the counts of all notes of that kind whose thing and reason hold the given parts.
inline std::uint64_t noted(const Scene& scene, LoadNote::Kind kind, const std::string& what, const std::string& why = "") {
  std::uint64_t count = 0;
  for (const LoadNote& note : scene.notes) {
    const bool same = note.kind == kind && note.what.find(what) != std::string::npos && note.why.find(why) != std::string::npos;
    if (same) count += note.count;
  }
  return count;
}

}  // namespace standin::test
