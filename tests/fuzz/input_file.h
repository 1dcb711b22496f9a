// A folder in memory for readers that take a file, one for each process, gone with it; and what a reader may do with a stranger's bytes:
// read them, or refuse them with a word that says whose fault it is. Anything else (another exception, a word that blames us) is a finding.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace standin::fuzz {

class InputFolder {
 public:
  InputFolder() { std::filesystem::create_directories(path_); }
  ~InputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  InputFolder(const InputFolder&) = delete;
  InputFolder& operator=(const InputFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::path file = path_ / name;
    std::FILE* stream = std::fopen(file.c_str(), "wb");
    if (stream == nullptr) std::abort();
    std::fwrite(bytes.data(), 1, bytes.size(), stream);
    std::fclose(stream);
    return file;
  }

 private:
  static std::filesystem::path memory() {
    return std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  }
  std::filesystem::path path_ = memory() / ("standin_fuzz_" + std::to_string(::getpid()));
};

inline InputFolder& input_folder() {
  static InputFolder folder;
  return folder;
}

inline std::string_view view_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

[[noreturn]] inline void finding(const std::string& sentence) {
  std::fprintf(stderr, "FINDING: %s\n", sentence.c_str());
  std::abort();
}

inline void require(bool holds, const char* sentence) {
  if (!holds) finding(sentence);
}

/// Whether it was read.
template <class Read>
bool read_or_refused(Read&& read) {
  try {
    read();
    return true;
  } catch (const Failure& failure) {
    if (failure.word() == ErrorWord::kInternal) finding(failure.what());
    return false;
  }
}

}  // namespace standin::fuzz
