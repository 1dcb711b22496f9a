// How long work may go on, and how it says how far it is.
//
// Stages take a WorkBudget by reference and call check() at every step worth less than a second: it throws
// Failure(kCancelled) once somebody asked to stop (Ctrl-C, a cancelled job). Nothing below the service reads a clock for a decision,
// so results do not depend on the machine's speed. What a stage has in hand before the end it tells by found().
#pragma once

#include <atomic>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>

#include "render/base/error.h"

namespace standin {

/// One figure of what would be the result if the work ended now; units are in the name.
struct Finding {
  std::string_view name;
  double value = 0.0;
};

class WorkBudget {
 public:
  using Progress = std::function<void(std::string_view stage, double fraction)>;
  using Findings = std::function<void(std::initializer_list<Finding>)>;

  WorkBudget() = default;
  explicit WorkBudget(const std::atomic<bool>* stop, Progress progress = {}, Findings findings = {})
      : stop_(stop), progress_(std::move(progress)), findings_(std::move(findings)) {}

  [[nodiscard]] bool stopped() const { return stop_ != nullptr && stop_->load(std::memory_order_relaxed); }
  void check() const {
    if (stopped()) throw Failure(ErrorWord::kCancelled, "stopped on request");
  }
  /// `fraction` in [0,1] of the named stage. May be called from any thread.
  void report(std::string_view stage, double fraction) const {
    if (progress_) progress_(stage, fraction);
  }
  /// The best so far: replaces what was told before under the same names. From one thread at a time.
  void found(std::initializer_list<Finding> best) const {
    if (findings_) findings_(best);
  }
  /// For a part of the work whose findings are not those of the whole.
  [[nodiscard]] WorkBudget without_findings() const { return WorkBudget(stop_, progress_); }

 private:
  const std::atomic<bool>* stop_ = nullptr;
  Progress progress_;
  Findings findings_;
};

}  // namespace standin
