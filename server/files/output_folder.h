// A result folder appears whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace standin {

/// Filled in a staging folder beside it, takes its place at commit(); an uncommitted one leaves no trace. What killed processes left behind
/// is swept away by the next job that is to write the same folder.
class OutputFolder {
 public:
  /// `job`: fingerprint of the job (one line). A folder that is not empty must hold a result of the same job, or Failure(kOutputOccupied)
  /// is thrown: it is replaced whole at commit().
  OutputFolder(std::filesystem::path folder, std::string job);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  void write(const std::string& name, std::string_view bytes) const;
  /// Where a file of it is to be written until then.
  [[nodiscard]] std::filesystem::path path_of(const std::string& name) const { return staging_ / name; }
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path staging_;
  bool committed_ = false;
};

}  // namespace standin
