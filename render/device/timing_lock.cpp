#include "render/device/timing_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "render/base/error.h"

namespace standin {
namespace {

[[noreturn]] void unusable(const std::filesystem::path& file) {
  throw Failure(ErrorWord::kDeviceUnavailable, "timing lock " + file.string() + ": " + std::strerror(errno));
}

constexpr std::chrono::milliseconds kLook{100};

// Locks of this process that are held, or waited for: flock knows no processes, and would have us wait for ourselves.
std::atomic<int> own_locks{0};

bool somebody_measures(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  const bool held = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(descriptor);
  return held;
}

// Reading suffices for flock, so that one user's lock file serves all; a shared folder may forbid O_CREAT on another user's file, hence the
// first attempt without it.
int open_lock_file(const std::filesystem::path& file) {
  constexpr int kFlags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW;
  int descriptor = open(file.c_str(), kFlags);
  if (descriptor < 0 && errno == ENOENT) descriptor = open(file.c_str(), kFlags | O_CREAT, 0644);
  if (descriptor < 0) unusable(file);
  return descriptor;
}

}  // namespace

TimingLock::TimingLock(const WorkBudget& budget, const std::filesystem::path& file) : descriptor_(open_lock_file(file)) {
  try {
    ++own_locks;
    while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK && errno != EINTR) unusable(file);
      budget.check();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  } catch (...) {
    --own_locks;
    close(descriptor_);
    throw;
  }
}

TimingLock::~TimingLock() {
  close(descriptor_);
  --own_locks;
}

void yield_to_timing(const WorkBudget& budget, const std::filesystem::path& file) {
  static std::atomic<std::chrono::steady_clock::time_point> last_look{};
  const auto now = std::chrono::steady_clock::now();
  if (own_locks > 0 || now - last_look.load() < kLook) return;
  while (somebody_measures(file)) {
    budget.check();
    std::this_thread::sleep_for(kLook);
  }
  last_look = std::chrono::steady_clock::now();
}

}  // namespace standin
