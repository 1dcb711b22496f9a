// One timing stage at a time on a machine: two that run together would each measure the other.
#pragma once

#include <filesystem>

#include "render/base/work.h"

namespace standin {

inline constexpr const char* kTimingLockFile = "/tmp/standin-timing.lock";

/// Exclusive lock (flock) that every timing stage holds, from the command line and from the service alike. The kernel releases it when its
/// holder dies.
class TimingLock {
 public:
  /// Blocks until it has the lock, checking the budget. Throws Failure(kCancelled); Failure(kDeviceUnavailable) where the file cannot be
  /// made.
  explicit TimingLock(const WorkBudget& budget, const std::filesystem::path& file = kTimingLockFile);
  ~TimingLock();
  TimingLock(const TimingLock&) = delete;
  TimingLock& operator=(const TimingLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// For work beside a timing stage: returns once no other process measures times. Looks at most ten times a second; a file that is not
/// there, or cannot be opened, is nobody's lock. Throws Failure(kCancelled).
void yield_to_timing(const WorkBudget& budget, const std::filesystem::path& file = kTimingLockFile);

}  // namespace standin
