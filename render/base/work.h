// How long work may go on, and how it says how far it is.
//
// Stages take a WorkBudget by reference and call check() at every step worth less than a second: it throws
// Failure(kCancelled) once somebody asked to stop (Ctrl-C, a cancelled job). Nothing below the service reads a clock for a decision,
// so results do not depend on the machine's speed.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace standin {

class WorkBudget {
 public:
  using Progress = std::function<void(std::string_view stage, double fraction)>;

  WorkBudget() = default;
  explicit WorkBudget(const std::atomic<bool>* stop, Progress progress = {}) : stop_(stop), progress_(std::move(progress)) {}

  [[nodiscard]] bool stopped() const { return stop_ != nullptr && stop_->load(std::memory_order_relaxed); }
  void check() const {
    if (stopped()) throw Failure(ErrorWord::kCancelled, "stopped on request");
  }
  /// `fraction` in [0,1] of the named stage. May be called from any thread.
  void report(std::string_view stage, double fraction) const {
    if (progress_) progress_(stage, fraction);
  }

 private:
  const std::atomic<bool>* stop_ = nullptr;
  Progress progress_;
};

}  // namespace standin
