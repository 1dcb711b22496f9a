#include "render/base/parallel.h"

#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace standin {
namespace {

// Keeps the exception of the lowest task index, so that the failure reported does not depend on scheduling.
class FirstFailure {
 public:
  void keep(std::size_t index, std::exception_ptr failure) {
    const std::scoped_lock lock(mutex_);
    if (!failure_ || index < index_) {
      index_ = index;
      failure_ = std::move(failure);
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::size_t index_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void parallel_for(std::size_t count, int threads, const WorkBudget& budget, const std::function<void(std::size_t)>& task) {
  if (threads <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) {
      budget.check();
      task(i);
    }
    return;
  }
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  FirstFailure first_failure;
  const auto run = [&] {
    for (std::size_t i = next++; i < count && !failed; i = next++) {
      try {
        budget.check();
        task(i);
      } catch (...) {
        first_failure.keep(i, std::current_exception());
        failed = true;
      }
    }
  };
  std::vector<std::thread> pool;
  const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(threads), count) - 1;
  pool.reserve(helpers);
  for (std::size_t i = 0; i < helpers; ++i) pool.emplace_back(run);
  run();
  for (auto& thread : pool) thread.join();
  first_failure.rethrow();
}

}  // namespace standin
