// How long a frame takes: the timing protocol.
//
// Thread CPU time between two glFinish, after warm-up draws; the least of `repeats`; a fixed reference frame is timed in between, and times
// are scaled by reference_now / reference_at_calibration, since the host's speed steps by up to 1.4x within a minute. Samples whose wall
// time exceeds 1.1x their CPU time are contaminated and repeated (at most twice as often as asked). Tests use FakeFrameTimer:
// deterministic, a function of the counts.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "render/base/work.h"
#include "render/device/renderer.h"

namespace standin {

struct FrameSample {
  double milliseconds = 0.0;      // minimum, normalised by the reference frame
  double raw_milliseconds = 0.0;  // minimum, as measured
  double spread = 0.0;            // (median - minimum) / minimum of the repeats
  int rejected = 0;               // contaminated repeats
};

class FrameTimer {
 public:
  virtual ~FrameTimer() = default;
  [[nodiscard]] virtual FrameSample time(Renderer& renderer, const View& view, const DrawList& list) = 0;
  /// Milliseconds of the reference frame, median over this timer's life; what a target file stores.
  [[nodiscard]] virtual double reference_ms() const = 0;
};

struct TimingProtocol {
  int warm_up = 1;
  int repeats = 9;            // minimum of
  double reference_ms = 0.0;  // of the calibration; 0: do not normalise, this is the calibration
};

/// Owns a context of its own for the reference frame where needed. Wall-clock devices come later.
[[nodiscard]] std::unique_ptr<FrameTimer> make_cpu_frame_timer(Context& context, const TimingProtocol& protocol);
/// milliseconds = f(counts of the frame).
[[nodiscard]] std::unique_ptr<FrameTimer> make_fake_frame_timer(std::function<double(const FrameCounts&)> milliseconds);

/// Exclusive machine-wide lock (flock) that every timing stage holds; blocks, checking the budget.
class TimingLock {
 public:
  explicit TimingLock(const WorkBudget& budget);
  ~TimingLock();
  TimingLock(const TimingLock&) = delete;
  TimingLock& operator=(const TimingLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace standin
