// Jobs, uploads and events that survive the process: what was accepted is never lost, and never done twice at a time.
//
// A job is queued, then running, then in one of three final states; every change is one transaction, and an event for those who watch.
// Whatever a job reads and leaves is named by SHA-256 here and lies in the blob store.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/store/database.h"
#include "server/store/job_record.h"

namespace standin {

struct JobFilter {
  std::optional<JobState> state;
  std::string kind;         // empty: any
  std::int64_t before = 0;  // a cursor of an earlier page; 0: from the newest
  int limit = 50;
};

struct JobPage {
  std::vector<Job> jobs;             // newest first
  std::optional<std::int64_t> next;  // cursor of the next page
};

struct Submission {
  Job job;
  bool replayed = false;  // the same key came with the same body before
};

/// Jobs that may wait.
struct QueueLimits {
  std::size_t all = 100;
  std::size_t of_one_owner = 100;
};

class JobStore {
 public:
  explicit JobStore(const std::filesystem::path& file, QueueLimits limits = {});

  /// `key`: of Idempotency-Key, or empty. Throws Failure(kKeyReused) where it came with another body, Failure(kQueueFull).
  Submission submit(const NewJob& job, const std::string& key);
  /// What came with that key before; nothing where the key is empty or new. Throws Failure(kKeyReused).
  [[nodiscard]] std::optional<Job> earlier(const std::string& owner, const std::string& key, const nlohmann::json& request);
  /// Of this owner; an empty owner sees all.
  [[nodiscard]] std::optional<Job> find(const std::string& owner, const std::string& id);
  [[nodiscard]] JobPage list(const std::string& owner, const JobFilter& filter);
  [[nodiscard]] std::map<std::string, StoredFile> inputs_of(const std::string& id);
  [[nodiscard]] std::vector<StoredFile> artifacts_of(const std::string& id);
  /// Later than `after`, oldest first.
  [[nodiscard]] std::vector<JobEvent> events_of(const std::string& id, std::int64_t after);

  /// The next queued job becomes a running one, with one attempt more: owners take turns, and each one's jobs go in their order.
  std::optional<Job> start_next();
  void report(const std::string& id, const std::string& stage, double fraction, const nlohmann::json& best_so_far);
  void finish(const std::string& id, const JobEnd& end);
  /// Back into its place in the queue: its worker is gone. `counted`: the attempt counts as one.
  void requeue(const std::string& id, bool counted);
  /// A queued job is cancelled at once, a running one by its worker. Returns the job; nothing where there is none.
  std::optional<Job> ask_cancel(const std::string& owner, const std::string& id);
  /// Throws Failure(kNotFinished) while it runs. False: there is none.
  bool remove(const std::string& owner, const std::string& id);

  [[nodiscard]] std::vector<Job> in_state(JobState state);
  [[nodiscard]] std::map<std::string, std::int64_t> counts_by_state();

  Upload add_upload(const std::string& owner, const StoredFile& file);
  [[nodiscard]] std::optional<Upload> find_upload(const std::string& owner, const std::string& id);
  [[nodiscard]] std::vector<Upload> uploads_of(const std::string& owner);
  bool remove_upload(const std::string& owner, const std::string& id);
  /// Those that came before that moment, and whose file no job refers to.
  void remove_uploads_before(std::int64_t moment_ms);
  /// Of an owner's uploads and of the files of the owner's jobs, less those of the SHA-256 in `but`; the same bytes count once.
  [[nodiscard]] std::uint64_t bytes_of(const std::string& owner, const std::set<std::string>& but = {});
  /// SHA-256 of all that anything refers to.
  [[nodiscard]] std::vector<std::string> blobs_in_use();
  /// By the owner's latest jobs of the kind: medians, in proportion to the bytes of their scenes.
  [[nodiscard]] JobPrediction predict(const std::string& owner, const std::string& kind, std::uint64_t scene_bytes);
  /// Finished before that moment.
  [[nodiscard]] std::vector<Job> finished_before(std::int64_t moment_ms);

  /// Called after each change, with the job's id; from any thread.
  void on_change(std::function<void(const std::string&)> listener) { listener_ = std::move(listener); }

 private:
  Job job_at(Query& row) const;
  std::optional<Job> earlier_locked(const std::string& owner, const std::string& key, const std::string& request_sha256);
  std::optional<Job> find_locked(const std::string& owner, const std::string& id);
  void add_event(const Job& job);
  void changed(const std::string& id) const;
  void require_place_in_queue(const std::string& owner);
  void write_files(const std::string& id, const char* purpose, const std::map<std::string, StoredFile>& files);
  void end_locked(const std::string& id, const JobEnd& end);

  std::mutex mutex_;
  Database database_;
  QueueLimits limits_;
  std::function<void(const std::string&)> listener_;
};

/// Milliseconds since 1970.
[[nodiscard]] std::int64_t now_ms();
/// 128 random bits, in hex: cannot be guessed.
[[nodiscard]] std::string random_id();

}  // namespace standin
