// From the queue to the result: one thread for each worker that may run at a time.
//
// A worker that ends without an outcome took nothing with it but itself: its job goes back to its place in the queue when somebody killed
// it (a crash of its own ends the job), up to a number of attempts. What it had finished lies in the stage cache, so that the next attempt
// goes on from there. When the server stops, running jobs go back to the queue; when it dies, its workers die with it, and recover() at the
// next start does the same.
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/service/work_folder.h"
#include "server/store/blob_store.h"
#include "server/store/job_store.h"

namespace standin {

struct SchedulerConfig {
  std::filesystem::path program;  // that is started as a worker
  std::filesystem::path data;     // folder of work folders and stage caches
  int workers = 1;
  int most_attempts = 5;
  double deadline_s = 0.0;  // wall seconds of one attempt; 0: none
  WorkerLimits limits;
  std::uint64_t most_triangles = 100'000'000;  // of a scene
  std::uint64_t most_texels = 500'000'000;
  double keep_s = 30.0 * 24 * 3600;  // after a job has ended, or an upload came that no job uses; 0: for ever
  std::uint64_t most_cache_bytes = std::uint64_t{10} << 30;
};

class Scheduler {
 public:
  /// `blobs_in_use`: SHA-256 of what is not to be tidied away.
  Scheduler(SchedulerConfig config, JobStore& jobs, BlobStore& blobs, std::function<std::vector<std::string>()> blobs_in_use,
            std::function<void(const std::string&)> log);
  ~Scheduler() { stop(); }
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  /// Workers end, and running jobs go back to the queue. Returns when they have.
  void stop();
  /// There is something in the queue, or to cancel.
  void wake();
  /// Takes away what nothing refers to any more, and jobs that ended long ago. From one thread at a time.
  void tidy();
  /// Processor seconds that all workers have used.
  [[nodiscard]] double worker_cpu_s() const;

 private:
  class Attempt;
  void recover();
  void loop();
  [[nodiscard]] std::uint64_t changes();
  void wait_for_change(std::uint64_t seen);
  void run(const Job& job);
  [[nodiscard]] std::filesystem::path folder_of(const std::string& id) const { return config_.data / "work" / id; }
  [[nodiscard]] std::filesystem::path cache_of(const std::string& owner) const;

  const SchedulerConfig config_;
  JobStore& jobs_;
  BlobStore& blobs_;
  const std::function<std::vector<std::string>()> blobs_in_use_;
  const std::function<void(const std::string&)> log_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t changes_ = 0;
  std::atomic<bool> stopping_{false};
  std::mutex collecting_;  // artifacts that are blobs but in no job yet are not to be tidied away
  std::vector<std::thread> threads_;
};

}  // namespace standin
