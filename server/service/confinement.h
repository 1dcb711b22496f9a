// What a worker process may use: a hostile or huge scene ends one worker, not the machine.
//
// A worker puts these limits on itself before it opens anything from outside, and cannot lift them again. RLIMIT_DATA and not RLIMIT_AS:
// software renderers and allocators reserve far more address space than they touch.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <nlohmann/json.hpp>

namespace standin {

/// 0: no limit.
struct WorkerLimits {
  std::uint64_t data_bytes = std::uint64_t{8} << 30;
  std::uint64_t cpu_s = 24 * 3600;
  std::uint64_t open_files = 256;
  std::uint64_t file_bytes = std::uint64_t{8} << 30;  // of any one file that it writes
  int niceness = 10;
};

[[nodiscard]] nlohmann::json to_json(const WorkerLimits& limits);
[[nodiscard]] WorkerLimits worker_limits_from_json(const nlohmann::json& object);

/// Limits this process, ties its life to that of `parent`, and takes the network away where the system allows it. Throws
/// Failure(kInternal) where a limit cannot be set, Failure(kCancelled) where the parent is gone already.
void confine_this_process(const WorkerLimits& limits, pid_t parent);

}  // namespace standin
