// How much a selection may still do (anytime use: more exact for more work, and an answer at any limit).
//
// Work is counted in gains looked at, the unit of nearly all of the selection's time: under such a limit results are the same on every
// machine. A deadline is asked of the caller, who may read a clock; results then depend on the machine, and the summary says so. What is
// reached once stays reached, so that all later steps stop where they begin.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

namespace standin {

class SelectionWork {
 public:
  enum class Limit { kNone, kWork, kDeadline };

  SelectionWork() = default;
  /// `gains`: looked at already.
  SelectionWork(std::uint64_t most_gains, std::function<bool()> out_of_time, std::uint64_t gains = 0)
      : most_gains_(most_gains), out_of_time_(std::move(out_of_time)), gains_(gains) {}

  void spend(std::uint64_t gains) { gains_ += gains; }
  [[nodiscard]] bool exhausted() {
    if (reached_ != Limit::kNone) return true;
    if (gains_ >= most_gains_)
      reached_ = Limit::kWork;
    else if (out_of_time_ && out_of_time_())
      reached_ = Limit::kDeadline;
    return reached_ != Limit::kNone;
  }
  [[nodiscard]] Limit reached() const { return reached_; }
  [[nodiscard]] std::uint64_t gains() const { return gains_; }

 private:
  std::uint64_t most_gains_ = UINT64_MAX;
  std::function<bool()> out_of_time_;
  std::uint64_t gains_ = 0;
  Limit reached_ = Limit::kNone;
};

}  // namespace standin
