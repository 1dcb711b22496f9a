// Results appear whole or not at all: files are written beside their place and renamed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace standin {

/// Throws Failure(kFileMissing) naming the file where it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& file);
/// Writes beside `file`, then renames. Throws Failure(kInternal) where the folder cannot be written.
void write_file(const std::filesystem::path& file, std::string_view bytes);
/// Hex SHA-256.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// A result folder that is filled in a staging folder beside it and takes its place at commit(); an uncommitted one leaves no trace.
class OutputFolder {
 public:
  /// `job`: fingerprint of the job (one line). A folder that is not empty must hold a result of the same job, or Failure(kOutputOccupied)
  /// is thrown: it is replaced whole at commit().
  OutputFolder(std::filesystem::path folder, std::string job);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  void write(const std::string& name, std::string_view bytes) const;
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path staging_;
  bool committed_ = false;
};

}  // namespace standin
