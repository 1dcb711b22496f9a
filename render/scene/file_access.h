// Reading files that a scene names, without ever leaving the scene's folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace standin {

/// Throws Failure(kFileMissing).
[[nodiscard]] std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file);

/// The folder a scene lies in, and the only one its relative references may reach.
class SceneFolder {
 public:
  explicit SceneFolder(const std::filesystem::path& scene_file);

  /// Path of the file that a percent-encoded relative URI names. Throws Failure(kUriForbidden) for a scheme, an absolute path, a `..`, or
  /// a link that leads out of the folder. The file need not exist.
  [[nodiscard]] std::filesystem::path resolve_uri(const std::string& uri) const;
  /// The same for a plain path (not percent-encoded).
  [[nodiscard]] std::filesystem::path resolve_path(const std::string& path) const;
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Payload of a base64 `data:` URI. Throws Failure(kFileBroken) naming `place`.
[[nodiscard]] std::vector<std::uint8_t> decode_data_uri(const std::string& uri, const std::string& place);
[[nodiscard]] bool is_data_uri(const std::string& uri);

}  // namespace standin
