// One timing stage at a time on a machine: two that run together would each measure the other.
#pragma once

#include <filesystem>

#include "render/base/work.h"

namespace standin {

/// Exclusive lock (flock) that every timing stage holds, from the command line and from the service alike. The kernel releases it when its
/// holder dies.
class TimingLock {
 public:
  /// Blocks until it has the lock, checking the budget. Throws Failure(kCancelled); Failure(kDeviceUnavailable) where the file cannot be
  /// made.
  explicit TimingLock(const WorkBudget& budget, const std::filesystem::path& file = "/tmp/standin-timing.lock");
  ~TimingLock();
  TimingLock(const TimingLock&) = delete;
  TimingLock& operator=(const TimingLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace standin
