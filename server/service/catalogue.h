// Files that clients may name: those of a configured folder, kept up to date.
//
// Each is copied into the blob store when it appears or changes, so that naming it costs nothing, and that a job keeps what it was
// submitted with. Neither sub-folders nor hidden files nor links are offered.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/store/blob_store.h"

namespace standin {

class Catalogue {
 public:
  /// `folder`: empty: nothing is offered.
  Catalogue(std::filesystem::path folder, BlobStore& blobs, std::function<void(const std::string&)> log)
      : folder_(std::move(folder)), blobs_(blobs), log_(std::move(log)) {}

  /// Looks at the folder again, leaving out new files that were written to within the last `settle` seconds: they may not be whole. From
  /// one thread at a time.
  void refresh(std::chrono::seconds settle);
  [[nodiscard]] std::optional<StoredFile> find(const std::string& name) const;
  /// By name.
  [[nodiscard]] std::vector<StoredFile> files() const;

 private:
  struct Entry {
    std::filesystem::file_time_type written;
    StoredFile file;
  };
  void take(const std::filesystem::path& file, Entry entry, std::map<std::string, Entry>& found);

  const std::filesystem::path folder_;
  BlobStore& blobs_;
  const std::function<void(const std::string&)> log_;
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

}  // namespace standin
