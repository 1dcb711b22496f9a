#include "render/device/timing_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

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
    while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EWOULDBLOCK && errno != EINTR) unusable(file);
      budget.check();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

TimingLock::~TimingLock() {
  close(descriptor_);
}

}  // namespace standin
