// A folder of stages' results, each in a file named by the fingerprint of everything that it was made from.
//
// A second job after an edit finds there what the edit did not reach, and a job of another budget what does not depend on it (the thesis
// runs all of chapter 5 again). The name says what a result is, so nothing in the folder is ever out of date: an edit asks for other names.
// The name also holds the build identity (render/base/build_identity.h) and the stage's own format, so that no other code's result is
// taken. An entry is written beside its place and renamed: processes may share the folder, wherever they run, and one that is killed leaves
// nothing that is read. An entry that is cut short, damaged or of another layout counts as absent, and is replaced.
//
//   FOLDER/STAGE/HEX   magic, layout version, fingerprint of the inputs, length of the payload, its SHA-256, payload
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>

#include "render/base/bytes.h"
#include "render/base/fingerprint.h"

namespace standin {

/// A kind of results. Whoever changes what their bytes mean raises `format`.
struct CacheStage {
  std::string_view name;  // of its folder, and in metrics.json
  std::uint32_t format = 1;
};

/// What a run had of one stage.
struct CacheCounts {
  std::uint64_t hits = 0;    // results that were there
  std::uint64_t misses = 0;  // results that had to be made
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
};

struct CacheFigures {
  std::map<std::string, CacheCounts, std::less<>> stages;
  std::uint64_t write_failures = 0;  // results that could not be kept: the job goes on without
  std::string why_not_written;       // of the first
  std::uint64_t removed_entries = 0;
  std::uint64_t folder_bytes = 0;  // of all entries, this run's or not
};

/// May be used from several threads, and its folder by several processes.
class StageCache {
 public:
  /// Throws Failure(kBadUsage) where the folder cannot be made or written to.
  explicit StageCache(std::filesystem::path folder, const Fingerprint& build);

  /// What `decode(ByteReader&)` makes of the entry; nothing where there is none that can be read. `counts(value)`: whether it spares the
  /// work it was looked up for, and so is a hit.
  template <class Decode, class Counts>
  auto recall(const CacheStage& stage, const Fingerprint& inputs, const Decode& decode, const Counts& counts)
      -> std::optional<std::invoke_result_t<Decode, ByteReader&>>;
  template <class Decode>
  auto recall(const CacheStage& stage, const Fingerprint& inputs, const Decode& decode) {
    return recall(stage, inputs, decode, [](const auto&) { return true; });
  }
  /// A result that had to be made. Where it cannot be written, that is counted and no error.
  void keep(const CacheStage& stage, const Fingerprint& inputs, std::string_view payload);

  /// Deletes all entries that were neither recalled nor kept since this object was made, also other processes', and what killed ones left
  /// unfinished. Files that are none of ours stay.
  void remove_unused();

  [[nodiscard]] CacheFigures figures() const;
  [[nodiscard]] std::filesystem::path file_of(const CacheStage& stage, const Fingerprint& inputs) const;

 private:
  [[nodiscard]] Fingerprint name_of(const CacheStage& stage, const Fingerprint& inputs) const;
  [[nodiscard]] std::optional<std::string> read(const CacheStage& stage, const Fingerprint& name) const;
  void note_hit(const CacheStage& stage, const Fingerprint& name, std::size_t bytes, bool counts);
  void note_kept(const CacheStage& stage, const Fingerprint& name, std::size_t bytes, const std::string& why_not);

  std::filesystem::path folder_;
  Fingerprint build_;
  mutable std::mutex mutex_;
  CacheFigures figures_;
  std::set<std::filesystem::path> used_;  // STAGE/HEX
  std::atomic<std::uint64_t> staged_{0};  // files so far: each gets a name of its own
};

template <class Decode, class Counts>
auto StageCache::recall(const CacheStage& stage, const Fingerprint& inputs, const Decode& decode, const Counts& counts)
    -> std::optional<std::invoke_result_t<Decode, ByteReader&>> {
  const Fingerprint name = name_of(stage, inputs);
  const std::optional<std::string> payload = read(stage, name);
  if (!payload) return std::nullopt;
  try {
    ByteReader reader(*payload);
    auto value = decode(reader);
    reader.require_end();
    note_hit(stage, name, payload->size(), counts(value));
    return value;
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kFileBroken) throw;
    return std::nullopt;  // whole, and yet no such result: written by a stage whose format should have been raised
  }
}

}  // namespace standin
