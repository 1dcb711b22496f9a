// Files of the service, named by their SHA-256: uploads come in piece by piece, artifacts by a link, and the same bytes are kept once.
//
// A blob appears whole or not at all: it is written beside its place and linked there. Nothing refers to a path of a client's.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/fingerprint.h"
#include "server/store/job_record.h"

namespace standin {

class BlobStore {
 public:
  /// Makes the folder, and sweeps away what killed processes left half written.
  explicit BlobStore(std::filesystem::path folder);

  [[nodiscard]] std::filesystem::path path_of(const std::string& sha256) const;
  [[nodiscard]] bool holds(const std::string& sha256) const;
  /// A file of the same file system becomes a blob, too: it is linked, not copied. Returns its size and name.
  StoredFile adopt(const std::filesystem::path& file, const std::string& name);
  /// The same by a copy: of a file that others may write to.
  StoredFile copy(const std::filesystem::path& file, const std::string& name);
  /// Removes whatever `in_use` does not name and was not placed within the last `spared` seconds: what has just come in may not be in use
  /// yet.
  void keep_only(const std::vector<std::string>& in_use, std::chrono::seconds spared) const;

  /// A blob that is being received. Not finished, it leaves no trace.
  class Incoming {
   public:
    explicit Incoming(BlobStore& store);
    ~Incoming();
    Incoming(const Incoming&) = delete;
    Incoming& operator=(const Incoming&) = delete;

    /// Throws Failure(kDiskFull) where it cannot be written.
    void write(std::string_view piece);
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    StoredFile finish(const std::string& name);

   private:
    BlobStore& store_;
    std::filesystem::path file_;
    int descriptor_ = -1;
    std::uint64_t bytes_ = 0;
    std::uint64_t unflushed_ = 0;
    Fingerprinter sum_;
  };

 private:
  void place(const std::filesystem::path& from, const std::string& sha256) const;

  std::filesystem::path folder_;
};

}  // namespace standin
