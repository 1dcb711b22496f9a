// What the service remembers of a job, an upload and an event.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace standin {

enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };

[[nodiscard]] std::string_view state_name(JobState state);
[[nodiscard]] std::optional<JobState> state_named(std::string_view name);
[[nodiscard]] inline bool is_final(JobState state) {
  return state >= JobState::kSucceeded;
}

/// A file of the service: its bytes lie in the blob store under their SHA-256.
struct StoredFile {
  std::string name;  // of an upload or a scene, or the artifact's path
  std::uint64_t bytes = 0;
  std::string sha256;
};

struct Upload {
  std::string id;
  std::string owner;
  StoredFile file;
  std::int64_t created_ms = 0;  // since 1970
};

/// What a worker is to do: a job as it was accepted. The files it reads are blobs, so that nothing that happens to an upload reaches it.
struct NewJob {
  std::string owner;
  std::string kind;
  std::string label;
  nlohmann::json request;                    // as it came
  std::map<std::string, StoredFile> inputs;  // by role: "scene", "target" ...
};

/// What a job's last worker used.
struct JobUse {
  double cpu_s = 0.0;
  std::uint64_t peak_rss_bytes = 0;
};

struct Job {
  std::string id;
  std::string owner;
  std::string kind;
  std::string label;
  nlohmann::json request;
  JobState state = JobState::kQueued;
  std::string stage;      // of the running job, or the last one
  double fraction = 0.0;  // of the stage, in [0,1]
  std::int64_t created_ms = 0;
  std::optional<std::int64_t> started_ms;
  std::optional<std::int64_t> finished_ms;
  std::int64_t attempts = 0;  // worker processes started for it
  bool cancel_asked = false;
  std::optional<bool> aim_met;  // of a job that succeeded
  nlohmann::json problem;       // of one that failed: {"word", "detail"}; null
  nlohmann::json best_so_far;   // null before there is any
  std::optional<JobUse> used;   // of one that ended
};

struct JobEvent {
  std::int64_t id = 0;  // ascending within all jobs
  nlohmann::json data;
};

/// How a worker ended.
struct JobEnd {
  JobState state = JobState::kFailed;
  std::optional<bool> aim_met;
  nlohmann::json problem;
  std::vector<StoredFile> artifacts;
  std::optional<JobUse> used = {};
};

/// What a job of this kind and scene is likely to take, by earlier ones.
struct JobPrediction {
  double seconds = 0.0;
  double peak_rss_bytes = 0.0;
  int jobs = 0;  // that it goes by; 0: nothing is known
};

}  // namespace standin
